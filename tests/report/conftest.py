"""A diagnosis made by hand: a mass at a wall whose joint leaves out the effect of rate, and a sensor with a wrong gain."""

import numpy as np
import pytest
import xarray as xr

from crashkit.diagnose.result import Alternative, Diagnosis, Estimate, Finding, Fit
from crashkit.model import Body, Joint, Model, Parameter

SPEEDS = {"run_1.nc": 8.5, "run_2.nc": 11.0, "run_3.nc": 13.5, "holdout_1.nc": 18.0}
MASS, STIFFNESS, PLATEAU, UNLOADING = 1150.0, 1.1e6, 1.6e5, 5.0e6
TIMES = np.arange(0.0, 0.16, 1e-4)
FILM = TIMES[::10]
NOISE = {"film": 1e-3, "accelerometer": 4.0}


def simulate(speed: float, plateau: float, rate: float) -> dict[str, np.ndarray]:
    """Deformation, rate and static force of one mass on a plateau whose force grows with rate."""
    deformation, velocity, largest = np.zeros_like(TIMES), np.full_like(TIMES, speed), 0.0
    static, force = np.zeros_like(TIMES), np.zeros_like(TIMES)
    for i in range(len(TIMES)):
        largest = max(largest, deformation[i])
        static[i] = max(0.0, min(STIFFNESS * largest, plateau) - UNLOADING * (largest - deformation[i]))
        force[i] = static[i] * max(0.0, 1.0 + rate * velocity[i])
        if i + 1 < len(TIMES):
            velocity[i + 1] = velocity[i] - 1e-4 * force[i] / MASS
            deformation[i + 1] = deformation[i] + 1e-4 * velocity[i + 1]
    return {"deformation": deformation, "rate": velocity, "static": static, "force": force}


def instrument(name: str, truth: dict, before: dict, after: dict, holdout: bool, noise: np.random.Generator) -> xr.Dataset:
    """The curves of the film (two markers, one hidden for a while) or of the accelerometer (one of two with a wrong gain)."""
    film = name == "film"
    pick = (lambda run: run["deformation"][::10] - 1.6) if film else (lambda run: -run["force"] / MASS)
    gains = np.array([1.0, 1.0]) if film else np.array([1.0, 1.06])
    recorded = pick(truth)[:, None] * gains + NOISE[name] * noise.normal(size=(len(pick(truth)), 2))
    if film:
        recorded[60:85, 1] = np.nan
    both = np.ones(2)
    return xr.Dataset(
        {
            "recorded": (("time", "channel"), recorded),
            "before": (("time", "channel"), pick(before)[:, None] * both),
            "after": (("time", "channel"), pick(after)[:, None] * gains),
            "std": (("time", "channel"), np.full_like(recorded, NOISE[name])),
        },
        {"time": FILM if film else TIMES, "channel": ["front_target", "rear_target"] if film else ["sill_left", "sill_right"]},
        {
            "holdout": int(holdout),
            "quantity": "position" if film else "acceleration",
            "units": "m" if film else "m s-2",
        },
    )


def fit(curves: xr.DataTree, model: str, holdout: bool) -> Fit:
    """The fit that the curves show."""
    names, columns, squares = [], {"normalised_rmse": [], "relative_rmse": [], "rating": [], "independent_samples": []}, []
    for run, instruments in curves.children.items():
        for name, node in instruments.children.items():
            if bool(node.attrs["holdout"]) != holdout:
                continue
            residual = (node["recorded"] - node[model]).values
            normalised = residual / node["std"].values
            squares.append(normalised[np.isfinite(normalised)] ** 2)
            for index, channel in enumerate(node["channel"].values):
                names.append(f"{run}/{name}/{channel}")
                size = np.sqrt(np.nanmean(node["recorded"].values[:, index] ** 2))
                columns["normalised_rmse"].append(np.sqrt(np.nanmean(normalised[:, index] ** 2)))
                columns["relative_rmse"].append(np.sqrt(np.nanmean(residual[:, index] ** 2)) / size)
                columns["rating"].append(0.97 if model == "after" else 0.83)
                columns["independent_samples"].append(float(np.isfinite(residual[:, index]).sum()))
    table = xr.Dataset({name: ("channel", values) for name, values in columns.items()}, {"channel": names})
    return Fit(float(np.sqrt(np.concatenate(squares).mean())), table)


def missing(truth: dict, before_plateau: float, holdout: bool, noise: np.random.Generator) -> xr.Dataset:
    """The missing force that film at 1 kHz would show, and the rate effect that explains it."""
    static = truth["static"][::10] * before_plateau / PLATEAU
    std = 4e3 + 2e3 * np.exp(-(((FILM - 0.0) / 0.01) ** 2))
    rough = np.convolve(noise.normal(size=len(FILM) + 6), np.ones(7) / 7, mode="valid") * np.sqrt(7)
    return xr.Dataset(
        {
            "missing_force": ("time", truth["force"][::10] - static + std * rough),
            "missing_force_std": ("time", std),
            "modelled_force": ("time", truth["force"][::10] - static),
            "deformation": ("time", truth["deformation"][::10]),
            "deformation_rate": ("time", truth["rate"][::10]),
        },
        {"time": FILM},
        {"place": "joint front", "holdout": int(holdout)},
    )


def crash_model(crush_force: float, factors: tuple[str, ...] = ()) -> Model:
    """The mass and its joint."""
    wall = Body("wall", (0.0,), (0.0,), fixed=True)
    vehicle = Body("vehicle", (-1.6,), (13.5,), Parameter(MASS, fixed=True))
    parameters = {"elastic_stiffness": Parameter(STIFFNESS), "crush_force": Parameter(crush_force)}
    joint = Joint("front", ("wall", "vehicle"), "crush_plateau", parameters, factors)
    return Model("one-mass frontal", ("x",), (wall, vehicle), (joint,))


def findings() -> tuple[Finding, ...]:
    """Rate dependence at the joint, with a rival, and a wrong gain."""
    rate = Finding(
        physics="rate_dependence",
        form="linear",
        sentence="The force of joint front rises with the rate of deformation: at 10 m/s it is 22 % above its static value.",
        probability=0.972,
        location={"joint": "front"},
        runs=tuple(SPEEDS),
        time=(0.0012, 0.094),
        phase="loading",
        parameters={"rate_coefficient": Estimate(0.0221, 0.0006, "s m-1"), "crush_force": Estimate(1.602e5, 900.0, "N")},
        alternatives=(
            Alternative("viscous_damping", "linear", {"joint": "front"}, 0.021),
            Alternative("rate_dependence", "power", {"joint": "front"}, 0.0061),
            Alternative("joint_friction", "", {"joint": "front"}, 0.0004),
        ),
        experiment="The same at 4 m/s: damping and rate dependence would differ by 6 standard deviations in sill_left.",
    )
    gain = Finding(
        physics="gain_error",
        form="constant",
        sentence="The sensor sill_right reads 6 % too much; sill_left and the film agree with each other.",
        probability=0.9996,
        location={"sensor": "sill_right", "instrument": "accelerometer"},
        runs=tuple(SPEEDS),
        time=(0.0, 0.16),
        phase="both",
        parameters={"gain": Estimate(1.0603, 0.0011, "1")},
    )
    return rate, gain


def ranking() -> xr.Dataset:
    """Thirty hypotheses in two rounds."""
    generator = np.random.default_rng(4)
    names = [
        "rate_dependence",
        "viscous_damping",
        "joint_friction",
        "gain_error",
        "bottoming",
        "clearance",
        "carried_load",
    ] * 3
    drops = np.sort(generator.exponential(400.0, size=len(names)))[::-1]
    probabilities = np.array([0.972, 0.021, 0.0061, 0.0004] + [1e-9] * (len(names) - 4))
    second = ["gain_error", "bias", "nothing", "clock_offset", "unknown"]
    return xr.Dataset(
        {
            "physics": ("hypothesis", names + second),
            "form": ("hypothesis", ["linear", "linear", ""] * 7 + ["constant", "constant", "", "", "smooth"]),
            "place": ("hypothesis", ["joint front"] * 21 + ["sensor sill_right"] * 5),
            "round": ("hypothesis", [1] * 21 + [2] * 5),
            "parameters": ("hypothesis", [1, 1, 1] * 7 + [1, 1, 0, 1, 8]),
            "misfit_drop": ("hypothesis", [*(40 * drops), 812.0, 96.0, 0.0, 3.1, 120.0]),
            "left_out_drop": ("hypothesis", [*(11 * drops[:4]), *[np.nan] * 17, 260.0, 12.0, np.nan, np.nan, np.nan]),
            "probability": ("hypothesis", [*probabilities, 0.9996, 3e-4, 1e-7, 1e-9, 1e-5]),
        }
    )


def identified() -> xr.Dataset:
    """The parameters of the augmented model."""
    return xr.Dataset(
        {
            "value": ("parameter", [1.09e6, 1.602e5, 0.0221, 4.9e6, 1.0603]),
            "std": ("parameter", [2.1e4, 900.0, 0.0006, 8.0e6, 0.0011]),
            "units": ("parameter", ["N m-1", "N", "s m-1", "N m-1", "1"]),
            "identifiable": ("parameter", [True, True, True, False, True]),
            "before": ("parameter", [1.31e6, 1.91e5, np.nan, 3.2e6, np.nan]),
        },
        {
            "parameter": [
                "joint.front.elastic_stiffness",
                "joint.front.crush_force",
                "joint.front.rate_coefficient",
                "joint.front.unloading_stiffness",
                "instrument.accelerometer.sill_right.gain",
            ]
        },
    )


def consistency() -> xr.Dataset:
    """Two comparisons, one of which disagrees."""
    return xr.Dataset(
        {
            "sentence": (
                "check",
                [
                    "sill_left, integrated twice, agrees with the film",
                    "sill_right, integrated twice, leaves the film by 41 mm",
                ],
            ),
            "sigma": ("check", [0.8, 36.2]),
            "place": ("check", ["sensor sill_left", "sensor sill_right"]),
        }
    )


SUMMARY = """\
The model leaves out physics: its own parameters, re-identified on 3 runs, leave a residual 4.6 times the noise.
1. Rate dependence (linear) at joint front, 97 %: the force of joint front rises with the rate of deformation.
2. Gain error at sensor sill_right, > 99.9 %: it reads 6 % too much.
With both, the residual of the held-out run falls from 9.1 to 1.0 times the noise; only noise is left.
Rate dependence and viscous damping are not fully told apart: a test at 4 m/s would."""


def make_diagnosis() -> Diagnosis:
    """All parts of a diagnosis filled."""
    noise = np.random.default_rng(1)
    curves, forces = {}, {}
    for run, speed in SPEEDS.items():
        truth, after = simulate(speed, PLATEAU, 0.022), simulate(speed, 1.602e5, 0.0221)
        before, holdout = simulate(speed, 1.91e5, 0.0), run.startswith("holdout")
        for name in ("film", "accelerometer"):
            curves[f"{run}/{name}"] = instrument(name, truth, before, after, holdout, noise)
        forces[f"0/{run}"] = missing(truth, PLATEAU, holdout, noise)
    tree = xr.DataTree.from_dict(curves)
    return Diagnosis(
        verdict="missing_physics",
        summary=SUMMARY,
        findings=findings(),
        base_model=crash_model(1.91e5),
        augmented_model=crash_model(1.602e5, ("rate_factor",)),
        fits={
            name: {model: fit(tree, model, holdout) for model in ("before", "after")}
            for name, holdout in (("calibration", False), ("holdout", True))
        },
        curves=tree,
        missing_force=xr.DataTree.from_dict(forces),
        ranking=ranking(),
        consistency=consistency(),
        identified=identified(),
        notes=(
            "The unloading stiffness is not identifiable: no run rebounds far enough.",
            "Without a recorded wall force, the mass and every force share one scale, set by the mass given for the vehicle.",
        ),
    )


@pytest.fixture(scope="session")
def diagnosis() -> Diagnosis:
    """A diagnosis with two findings, three fitted runs and one held out."""
    return make_diagnosis()
