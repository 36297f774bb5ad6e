"""A real impactor with a programmed joint (CyberDiver): is its damper found, and nothing where there is none?

Two masses drop into water at 4 m/s. The joint between them was programmed to be a spring, and in one of two drops a damper
beside it. The tool is given a spring without damper, how the joint deformed, and 0.1 s of its force. The force later on, the
accelerometer and what was programmed are opened only to compare. The recordings are in the folder that the environment
variable CRASHKIT_RECORDINGS names (else ../shared/recordings beside the checkout).
"""

import os
from pathlib import Path
from time import perf_counter

import numpy as np
import xarray as xr

from benchmarks import Row
from crashkit.api import workshop
from crashkit.data.channel_filter import filter_channel
from crashkit.diagnose import Diagnosis, diagnose
from crashkit.model import Body, GivenMotion, InstrumentErrors, Joint, Model, Parameter

TEST = "cyberdiver_impact"
DROPS = {"undamped": "15npmm_4mps_trial1.dat", "damped": "15npmm_4mps_025damping_trial1.dat"}
STATIC = "static_force_test_15npmm.csv"
PROGRAMMED = 15e3
"""N m-1, the spring in both drops."""

HEADER = 14720
"""Bytes before the records."""
RECORD = np.dtype(
    [("time", "<u4")]
    + [(name, "<f4") for name in ("current", "force", "position", "velocity", "duty", "ax", "ay", "az", "setpoint")]
    + [("status", "<u4")]
)
DAMPING = HEADER - 72
"""The byte where the header says the programmed damping, N s mm-1."""
INTERVAL = 2e-5
"""s; the stamps stray from it by 1 us."""
CLASS, EVERY = 1000, 15
"""Frequency class (Hz) to which all channels are brought; every fifteenth sample is then independent of the next."""
GRAVITY = 9.80665
"""m s-2."""

CONTACT = 0.4
"""s of the record when the nose meets the water; times are counted from it."""
REST = slice(-0.2, -0.01)
"""s: the fall, in which nothing acts."""
SEEN = 0.1
"""s that are shown; the rest is held out."""
LIMIT, EDGE = 0.99, 4e-4
"""Share of the coil's voltage at which the joint is not what was programmed, and the s before it that a filter spoils."""
LATE = slice(0.2, 0.59)
"""s: long after the coil was at its limit; the joint has another zero by then."""
CELL, SPRING = "load_cell", "spring alone, re-identified"
LENGTH = 0.1
"""m between the two ends at rest; only its changes matter."""
STILL = 1e6
"""kg of the end that stands still: a model has at least one body that forces move."""


def run() -> list[Row]:
    """What was found in both drops, against what was programmed and what was held out."""
    records, stiffness = {drop: read(drop) for drop in DROPS}, static_stiffness()
    rear = mass(records["undamped"])
    rows, late = [Row("static test: stiffness", "error", "N m-1", stiffness, "programmed", PROGRAMMED)], 0.0
    for drop, delay_is_told in (("undamped", False), ("damped", False), ("damped", True)):
        name = f"{drop}, delay told" if delay_is_told else drop
        start = perf_counter()
        answer = diagnosed(records[drop], stiffness, late if delay_is_told else 0.0)
        elapsed = perf_counter() - start
        print(f"{name}: {answer.summary}\n", flush=True)
        rows += [*_claim_rows(name, records[drop], answer), *_residual_rows(name, records[drop], answer, rear)]
        rows.append(Row(f"{name}: diagnosis", "time", "s", elapsed, "", None))
        late = late or delay(answer)
    return rows


def recordings() -> Path:
    """Where the recordings are."""
    beside = Path(__file__).parent.parent.parent / "shared" / "recordings"
    return Path(os.environ.get("CRASHKIT_RECORDINGS", beside)) / TEST


def read(drop: str) -> xr.Dataset:
    """What a drop recorded over `time` (s from first contact).

    Returns:
        Dataset with the joint's `deformation` (m) and `force` (N), compression positive, and the `acceleration` (m s-2) of the
        rear mass; attributes `limit` (s), when the coil is at its limit, and `damping` (N s m-1), as programmed.
    """
    content = (recordings() / DROPS[drop]).read_bytes()
    raw = np.frombuffer(content, RECORD, offset=HEADER)
    times = INTERVAL * np.arange(len(raw)) - CONTACT
    channels = {"deformation": 1e-3 * raw["position"], "force": -raw["force"], "acceleration": GRAVITY * raw["ay"]}
    filtered = {name: filter_channel(values.astype(float), times, CLASS)[::EVERY] for name, values in channels.items()}
    limit = times[(times > 0.0) & (np.abs(raw["duty"]) > LIMIT)][0] - EDGE
    damping = 1e3 * float(np.frombuffer(content, "<f4", 1, DAMPING)[0])
    return xr.Dataset(
        {name: ("time", values) for name, values in filtered.items()},
        {"time": times[::EVERY]},
        {"limit": float(limit), "damping": damping},
    )


def static_stiffness() -> float:
    """N m-1, of three slow compressions in a testing machine, beyond the first 0.2 mm of free play."""
    trials = np.genfromtxt(recordings() / STATIC, delimiter=",", skip_header=1).reshape(-1, 3, 2)
    deformation, force = -trials[..., 0].ravel(), -trials[..., 1].ravel()
    return 1e3 * float(np.polyfit(deformation[deformation > 0.2], force[deformation > 0.2], 1)[0])


def given(record: xr.Dataset, stiffness: float, late: float) -> Model:
    """A spring between two ends, one still, one moving as was recorded; its force is read `late` (s)."""
    moving = record.sel(time=slice(0.0, record.attrs["limit"]))
    place = moving["deformation"].values - LENGTH
    motion = GivenMotion(tuple(moving["time"].values.tolist()), tuple((float(x),) for x in place))
    rear = Body("rear", (0.0,), (0.0,), Parameter(STILL, fixed=True))
    nose = Body("nose", (float(place[0]),), (0.0,), motion=motion)
    spring = {"stiffness": Parameter(stiffness, 0.1 * stiffness, 10.0 * stiffness)}
    joint = Joint("structure", ("rear", "nose"), "tie", spring, free_length=Parameter(LENGTH, fixed=True))
    clock = InstrumentErrors(CELL, "", {"clock_offset": Parameter(late, fixed=True)})
    return Model("CyberDiver", ("x",), (rear, nose), (joint,), (clock,) if late else ())


def recording(record: xr.Dataset, start: float, end: float, title: str) -> xr.DataTree:
    """A part of a drop as a load cell on the rear mass saw it; the noise is that of the fall."""
    rest, part = record.sel(time=REST), record.sel(time=slice(start, end))
    noise = float((rest["force"] - PROGRAMMED * rest["deformation"]).std())
    cell = xr.Dataset(
        {
            "force": (("time", "sensor", "axis"), part["force"].values[:, None, None], {"units": "N"}),
            "sensor_body": ("sensor", ["rear"]),
            "force_std": ("sensor", [noise], {"units": "N"}),
        },
        {"time": ("time", part["time"].values, {"units": "s"}), "sensor": ["cell"], "axis": ["x"]},
        {"observer": "load_cell"},
    )
    root = xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": title})
    return xr.DataTree.from_dict({"/": root, CELL: cell})


def diagnosed(record: xr.Dataset, stiffness: float, late: float = 0.0) -> Diagnosis:
    """The answer to the spring and the first part of a drop; the rest is held out."""
    shown = {"entry": recording(record, 0.0, SEEN, "entry into the water")}
    unseen = {"later": recording(record, SEEN, record.attrs["limit"], "later")}
    return diagnose(given(record, stiffness, late), shown, unseen, workshop())


def mass(record: xr.Dataset) -> float:
    """kg of the rear: the recorded force over the recorded acceleration, of the shown part."""
    shown = record.sel(time=slice(0.0, SEEN))
    acceleration = shown["acceleration"] - _bias(record)
    return -float((shown["force"] * acceleration).sum() / (acceleration**2).sum())


def delay(answer: Diagnosis) -> float:
    """s by which the force was found to be late; 0 where it was not."""
    late = answer.augmented_model.parameters().get(f"instrument.{CELL}..clock_offset")
    return late.value if late else 0.0


def late_damping(record: xr.Dataset) -> float:
    """N s m-1, by a regression of the force on deformation, rate and 1 in a part of the record that the tool never sees."""
    rate = record["deformation"].differentiate("time")
    late = [one.sel(time=LATE).values for one in (record["deformation"], rate, record["force"])]
    table = np.column_stack([late[0], late[1], np.ones(len(late[0]))])
    return float(np.linalg.lstsq(table, late[2], rcond=None)[0][1])


def _claim_rows(name: str, record: xr.Dataset, answer: Diagnosis) -> list[Row]:
    """What is said to be in the joint."""
    found = [finding for finding in answer.findings if "joint" in finding.location]
    damping = sum(one.parameters["damping"].value for one in found if one.physics == "viscous_damping")
    identified = answer.identified["value"].sel(parameter="joint.structure.stiffness")
    rows = [
        Row(
            f"{name}: findings in the joint", "error", "1", float(len(found)), "programmed", float(record.attrs["damping"] > 0)
        ),
        Row(f"{name}: stiffness", "error", "N m-1", float(identified), "programmed", PROGRAMMED),
        Row(f"{name}: damping", "error", "N s m-1", float(damping), "programmed", record.attrs["damping"]),
        Row(f"{name}: damping", "error", "N s m-1", float(damping), "regression of 0.2 to 0.59 s", late_damping(record)),
        Row(f"{name}: delay of the force", "error", "s", delay(answer), "", None),
    ]
    return rows + [
        Row(f"{name}: probability of {one.physics}", "rate", "1", one.probability, "", None) for one in answer.findings
    ]


def _residual_rows(name: str, record: xr.Dataset, answer: Diagnosis, rear: float) -> list[Row]:
    """Of the shown force, of the force held out, and of the accelerometer; the peer is the spring alone, re-identified."""
    rows = []
    for run, part in (("calibration", "shown"), ("holdout", "held out")):
        after, before = (answer.fits[run][when] for when in ("after", "before"))
        sizes = [float(fit.channels["relative_rmse"].values[0]) for fit in (after, before)]
        noise = (after.normalised_rmse, before.normalised_rmse)
        rows.append(Row(f"{name}: force {part}, residual over noise", "error", "1", noise[0], SPRING, noise[1]))
        rows.append(Row(f"{name}: force {part}, relative residual", "error", "1", sizes[0], SPRING, sizes[1]))
    ours, theirs = (_acceleration_residual(record, answer, when, rear) for when in ("after", "before"))
    return [*rows, Row(f"{name}: acceleration, relative residual", "error", "1", ours, SPRING, theirs)]


def _acceleration_residual(record: xr.Dataset, answer: Diagnosis, when: str, rear: float) -> float:
    """Of the accelerometer against a = -F / m, over both parts."""
    curves = [answer.curves[f"{run}/{CELL}"].to_dataset()[when].isel(channel=0, drop=True) for run in ("entry", "later")]
    force = xr.concat(curves, "time")
    recorded = record["acceleration"].sel(time=force["time"], method="nearest").values - _bias(record)
    return float(np.sqrt(np.sum((recorded + force.values / rear) ** 2) / np.sum(recorded**2)))


def _bias(record: xr.Dataset) -> float:
    """m s-2 that the accelerometer reads in the fall."""
    return float(record["acceleration"].sel(time=REST).mean())
