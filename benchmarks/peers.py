"""What a user would do today where a model misses something, beside a diagnosis: held-out residuals, and what is named.

Each peer starts from the given model, calibrated with scipy's least squares. The first adds a Gaussian process for what is
left of every channel, of time and impact speed, or of the joints' simulated deformations, rates and impact speed (Kennedy and
O'Hagan 2001, doi:10.1111/1467-9868.00294). The second regresses the missing forces of the joints on polynomials of deformation
and rate, sparsely (Brunton et al. 2016, doi:10.1073/pnas.1517384113), and simulates with them. All use crashkit's engine and
instruments, so that only ideas are compared. Only structural physics is concealed, in its plainest form and in a vehicle of
one body with all instruments, whose only joint is easily named; the noise is told.
"""

import warnings
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from benchmarks import Row
from benchmarks._sparse import sparse_regression
from benchmarks.blind.score import score
from benchmarks.blind.trial import diagnosed, read_diagnosis
from crashkit.api import load_model, load_recordings
from crashkit.diagnose.show.fits import fit_of, predict
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.misfit.predictor import Prediction
from crashkit.registry import load
from crashkit.testing.concealed import make_case, write_case
from crashkit.testing.concealed.body_effects import BODY_EFFECTS
from crashkit.testing.concealed.joint_effects import JOINT_EFFECTS

STRUCTURAL = sorted({*JOINT_EFFECTS, *BODY_EFFECTS} - {"unknown", "rotation"})
SIZES = ("middle", "gross")
DIFFERENCE = 1e-4
"""Relative step of scipy's differences."""
SAMPLES = 100
"""Of each channel of each run that a Gaussian process is given; its cost grows with the cube of all of them."""

Features = Callable[[Misfit, str, np.ndarray], np.ndarray]
"""Of a run at some instants: (time, feature)."""
Peer = Callable[[Misfit, Misfit], tuple[list[np.ndarray], str]]
"""From the calibrated misfit and the held-out one: predicted samples of each held-out group, and the guilty joint."""


def add_arguments(parser: ArgumentParser) -> None:
    """How many cases, and which."""
    parser.add_argument("--cases", metavar="N", type=int, default=4, help="how many (%(default)s)")
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of everything random (%(default)s)")
    parser.add_argument("--limit", metavar="S", type=float, default=600.0, help="s that a diagnosis may take (%(default)s)")


def run(options: Namespace) -> list[Row]:
    """For each case: the held-out residual over noise, whether physics and place were named, and the time."""
    rows = []
    for number in range(1, options.cases + 1):
        with TemporaryDirectory() as folder:
            answer = conceal(options.seed, number, Path(folder))
            rows += _rows(number, answer, Path(folder), options.limit)
    return rows


def conceal(seed: int, number: int, folder: Path) -> dict[str, Any]:
    """Write a case whose noise is told; returns its answer."""
    chance = np.random.default_rng([seed, number])
    while True:
        size, physics = str(chance.choice(SIZES)), str(chance.choice(STRUCTURAL))
        try:
            case = make_case((seed, number, int(chance.integers(2**31))), (physics,), size, plain=True)
        except ValueError:  # no vehicle shows it so
            continue
        groups = [group for recording in case.runs for group in recording.children.values() if "observer" in group.attrs]
        if all(any(str(name).endswith("_std") for name in group.data_vars) for group in groups):
            write_case(case, folder)
            return case.answer


def time_process(fitted: Misfit, unseen: Misfit) -> tuple[list[np.ndarray], str]:
    """A Gaussian process of time and impact speed."""
    return _process(fitted, unseen, lambda misfit, run, times: times[:, None])


def state_process(fitted: Misfit, unseen: Misfit) -> tuple[list[np.ndarray], str]:
    """A Gaussian process of the simulated deformations and their rates, and of impact speed."""
    return _process(fitted, unseen, _deformations)


PEERS: dict[str, tuple[str, Peer]] = {
    "Gaussian process of time": ("sklearn", time_process),
    "Gaussian process of deformation and rate": ("sklearn", state_process),
    "sparse regression of the force": ("pysindy", sparse_regression),
}
"""Each with the package that it needs."""


def _rows(number: int, answer: dict[str, Any], folder: Path, limit: float) -> list[Row]:
    secret = answer["secrets"][0]
    name = f"case {number}, {secret['physics']} ({secret['form']}), {answer['size']}"
    seconds = diagnosed(folder, folder / "diagnosis", limit)["seconds"]
    answered = (folder / "diagnosis" / "diagnosis.json").exists()
    said = read_diagnosis(folder / "diagnosis") if answered else None  # a crash, or beyond the limit
    ours = said["fit"]["holdout"]["after"]["normalised_rmse"] if said else np.nan
    named = float(said is not None and score(said, answer).place_right)
    start = perf_counter()
    fitted, unseen = _calibrated(folder)
    theirs = [("scipy's calibration", *_judged(unseen, [one.samples for one in predict(unseen)], "", answer))]
    rows = [Row(f"{name}: time", "time", "s", seconds, "scipy's calibration", perf_counter() - start)]
    for peer, (package, method) in PEERS.items():
        there = find_spec(package) is not None
        theirs.append((peer, *(_tried(method, fitted, unseen, answer) if there else (None, None))))
    for peer, residual, right in theirs:
        rows.append(Row(f"{name}: held-out residual over noise", "error", "1", ours, peer, residual))
        rows.append(Row(f"{name}: named what was concealed (theirs: the place at most)", "rate", "1", named, peer, right))
    return rows


def _calibrated(folder: Path) -> tuple[Misfit, Misfit]:
    """The fitted runs and the held-out one, at the values that scipy finds for the fitted ones."""
    model, registry = load_model(folder / "model.toml"), load()
    runs, unseen = (
        Misfit(model, load_recordings(sorted(folder.glob(f"{kind}_*.nc"))), registry.spring_laws, registry.observers)
        for kind in ("run", "holdout")
    )
    lower, upper = runs.bounds()
    start = np.clip(runs.start(), lower + 1e-9, upper - 1e-9)
    values = runs.values(least_squares(runs.residual, start, bounds=(lower, upper), diff_step=DIFFERENCE).x)
    return runs.with_values(values), unseen.with_values(values)


def _tried(method: Peer, fitted: Misfit, unseen: Misfit, answer: dict[str, Any]) -> tuple[float, float]:
    """What a peer's prediction is worth; nothing where what it found cannot be simulated."""
    try:
        return _judged(unseen, *method(fitted, unseen), answer)
    except SimulationError:
        return np.inf, 0.0


def _judged(unseen: Misfit, samples: list[np.ndarray], guilty: str, answer: dict[str, Any]) -> tuple[float, float]:
    """The held-out residual over noise, and whether the guilty joint was named."""
    right = any(kind == "joint" and place == guilty for _, kind, place in answer["accept"])
    return fit_of(unseen, [Prediction(part, None) for part in samples]).normalised_rmse, float(right)


def _process(fitted: Misfit, unseen: Misfit, features: Features) -> tuple[list[np.ndarray], str]:
    """What the calibrated model leaves of each channel is a sample of a Gaussian process; it names nothing."""
    told = []
    residuals = [group.recorded - one.samples for group, one in zip(fitted.groups, predict(fitted), strict=True)]
    for group, simulated in zip(unseen.groups, predict(unseen), strict=True):
        same = [(one, left) for one, left in zip(fitted.groups, residuals, strict=True) if one.name == group.name]
        known = [(_inputs(fitted, one.run, one.times, features), left) for one, left in same]
        wanted = _inputs(unseen, group.run, group.times, features)
        added = [_regressed([(x, left[:, n]) for x, left in known], wanted) for n in range(len(group.channels))]
        told.append(simulated.samples + np.column_stack(added))
    return told, ""


def _regressed(known: list[tuple[np.ndarray, np.ndarray]], wanted: np.ndarray) -> np.ndarray:
    """The mean of a Gaussian process through a part of what is known, where it is wanted."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

    parts = []
    for inputs, values in known:
        present = np.flatnonzero(np.isfinite(values))
        thin = present[:: max(1, len(present) // SAMPLES)]
        parts.append((inputs[thin], values[thin]))
    x, y = (np.concatenate(part) for part in zip(*parts, strict=True))
    scale = np.maximum(np.abs(x).max(axis=0), 1e-12)
    kernel = ConstantKernel() * RBF(np.full(x.shape[1], 0.3), (1e-2, 1e2)) + WhiteKernel(0.1, (1e-6, 1e1))
    process = GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=1, random_state=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a length at its bound is an answer here
        return np.asarray(process.fit(x / scale, y).predict(wanted / scale))


def _inputs(misfit: Misfit, run: str, times: np.ndarray, features: Features) -> np.ndarray:
    """The features, and the impact speed."""
    speed = float(np.abs(misfit.recordings[run].children["initial"]["velocity"].values).max())
    return np.column_stack([features(misfit, run, times), np.full(len(times), speed)])


def _deformations(misfit: Misfit, run: str, times: np.ndarray) -> np.ndarray:
    """(time, deformations and rates of all joints) as simulated."""
    values = {name: parameter.value for name, parameter in misfit.model.free_parameters().items()}
    motion = misfit.predictor.motion(run, values)
    table = np.column_stack([motion["deformation"].values, motion["deformation_rate"].values])
    return np.column_stack([np.interp(times, motion["time"].values, column) for column in table.T])
