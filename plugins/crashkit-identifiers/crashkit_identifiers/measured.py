"""The motion that the instruments of a run saw: for each body one spline through all its film and accelerometers."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.interpolate import BSpline
from scipy.linalg import eigh

from crashkit.errors import CrashkitError
from crashkit.misfit import Group, Misfit
from crashkit.misfit.predictor import initial_state

DEGREE = 5
MOST_KNOTS = 300
"""Intervals of a spline: half a millisecond in a crash."""
INITIAL = {"position": 1e-5, "velocity": 1e-4}
"""m, m s-1: how well the state at t = 0 is taken to be known."""
ORDERS = {"position": 0, "velocity": 1, "acceleration": 2}
SMOOTHINGS = np.logspace(-12.0, 6.0, 73)
"""Of the roughness against the misfit, as shares of their sizes."""
UNITS = {"position": "m", "velocity": "m s-1", "acceleration": "m s-2"}


def measured_motion(misfit: Misfit, run: str) -> xr.Dataset:
    """Position, velocity and acceleration of every body that an instrument of a run saw, from t = 0.

    Minimises Σ ((z_i - f^(k)(t_i)) / s_i)² + p ∫ (f''')² dt over quintic splines f, with k = 0 for positions, 1 for velocities and
    2 for accelerations, and with the state at t = 0 where the recording holds it; p by generalised cross-validation.
    Instruments' own errors are not taken out. Fixed bodies stay where they are.

    Returns:
        Dataset with `position`, `velocity`, `acceleration` (time, body, axis) and `<each>_std`, NaN for bodies that no
        instrument saw, and `seen` (body).
    """
    readings = _readings(misfit, run)
    times = instants(misfit, run)
    model = misfit.model
    shape = (len(times), len(model.bodies), len(model.axes))
    arrays = {name: np.full(shape, np.nan) for order in ORDERS for name in (order, f"{order}_std")}
    for row, body in enumerate(model.bodies):
        for column, axis in enumerate(model.axes):
            if body.fixed:
                still = {"position": body.position[column]}
                curves = {name: np.full(len(times), still.get(name, 0.0)) for name in arrays}
            else:
                curves = _curves([r for r in readings if (r.body, r.axis) == (body.name, axis)], times)
            for name, curve in curves.items():
                arrays[name][:, row, column] = curve
    by_body = ("time", "body", "axis")
    variables = {name: (by_body, values, {"units": UNITS[name.removesuffix("_std")]}) for name, values in arrays.items()}
    coords = {"time": times, "body": [body.name for body in model.bodies], "axis": list(model.axes)}
    motion = xr.Dataset(variables, coords)
    return motion.assign(seen=("body", np.isfinite(arrays["position"]).all(axis=(0, 2))))


def measured_motions(misfit: Misfit) -> dict[str, xr.Dataset]:
    """The measured motion of every run."""
    return {run: measured_motion(misfit, run) for run in misfit.recordings}


def require_seen(misfit: Misfit, measured: Mapping[str, xr.Dataset], method: str) -> None:
    """Raise CrashkitError where the instruments of a run saw nothing of a body that a joint holds."""
    bodies = list(dict.fromkeys(body for joint in misfit.model.joints for body in joint.bodies))
    for run, motion in measured.items():
        missing = [body for body in bodies if not bool(motion["seen"].sel(body=body))]
        if missing:
            raise CrashkitError(
                f"{run}: {method} needs the measured motion of every body that a joint holds, found none of "
                f"{', '.join(missing)}; a method that simulates, for example sensitivity, does without"
            )


def instants(misfit: Misfit, run: str) -> np.ndarray:
    """Every instant from t = 0 at which an instrument of the run reads the motion of a body."""
    stamps = np.concatenate([[0.0], *(group.times for group in misfit.groups if group.run == run)])
    stamps = np.unique(stamps[stamps >= 0.0])
    return stamps[np.concatenate([[True], np.diff(stamps) > 1e-9])]


@frozen(eq=False)
class _Reading:
    """Samples of one body along one axis, each as often as it tells something of its own."""

    body: str
    axis: str
    order: int
    times: np.ndarray
    values: np.ndarray
    std: float


def _readings(misfit: Misfit, run: str) -> list[_Reading]:
    readings = []
    for group in (g for g in misfit.groups if g.run == run):
        seen = group.observer.reconstruct(group.dataset)
        for quantity in (name for name in ORDERS if name in seen):
            table = seen[quantity].transpose("time", "body", "axis")
            for body in table["body"].values.tolist():
                for axis in table["axis"].values.tolist():
                    values = table.sel(body=body, axis=axis).values
                    readings.append(_reading(group, quantity, body, axis, values))
    return [*readings, *_initial(misfit, run)]


def _reading(group: Group, quantity: str, body: str, axis: str, values: np.ndarray) -> _Reading:
    """The mean of the sensors on a body; filtered channels are thinned to independent samples."""
    carriers = dict(zip(group.dataset[group.observer.channel].values, _carriers(group), strict=True))
    noises = [c.noise for c in group.channels if carriers[c.sensor] == body and c.axis == axis]
    std = float(np.sqrt(sum(noise.std**2 for noise in noises))) / len(noises)
    every = max(1, round(max(noise.correlation for noise in noises)))
    keep = np.flatnonzero(np.isfinite(values) & (group.times >= 0.0))[::every]
    return _Reading(body, axis, ORDERS[quantity], group.times[keep], values[keep], std)


def _carriers(group: Group) -> list[str]:
    return [str(body) for body in group.dataset[f"{group.observer.channel}_body"].values]


def _initial(misfit: Misfit, run: str) -> list[_Reading]:
    state = initial_state(misfit.recordings[run], misfit.model)
    if state is None:
        return []
    return [
        _Reading(body, axis, ORDERS[name], np.zeros(1), state[name].sel(body=[body], axis=axis).values, std)
        for name, std in INITIAL.items()
        for body in state["body"].values.tolist()
        for axis in state["axis"].values.tolist()
    ]


def _curves(readings: list[_Reading], times: np.ndarray) -> dict[str, np.ndarray]:
    """The spline of one body along one axis, with its derivatives; nothing where no instrument saw it."""
    if not any(len(reading.times) >= 2 * DEGREE for reading in readings):
        return {}
    stamps = np.unique(np.concatenate([reading.times for reading in readings]))
    span = (float(stamps[0]), max(float(stamps[-1]), float(times[-1])))
    count = min(len(stamps), MOST_KNOTS)
    knots = np.concatenate([[span[0]] * DEGREE, np.linspace(*span, count), [span[1]] * DEGREE])
    rows = np.concatenate([_basis(knots, r.times, r.order) / r.std for r in readings])
    target = np.concatenate([r.values / r.std for r in readings])
    coefficients, covariance = _smoothed(rows, target, _roughness(knots))
    inside = times <= stamps[-1]
    curves = {}
    for name, order in ORDERS.items():
        at = _basis(knots, times, order)
        curves[name] = np.where(inside, at @ coefficients, np.nan)
        curves[f"{name}_std"] = np.where(inside, np.sqrt(np.maximum(((at @ covariance) * at).sum(axis=1), 0.0)), np.nan)
    return curves


def _basis(knots: np.ndarray, times: np.ndarray, order: int) -> np.ndarray:
    spline = BSpline(knots, np.eye(len(knots) - DEGREE - 1), DEGREE)
    return np.asarray(spline(times, nu=order))


def _roughness(knots: np.ndarray) -> np.ndarray:
    """∫ f''' g''' dt of every pair of basis functions: three points of Gauss in each interval are exact."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    ends = np.unique(knots)
    half = 0.5 * np.diff(ends)
    at = (0.5 * (ends[1:] + ends[:-1])[:, None] + half[:, None] * nodes).ravel()
    third = _basis(knots, at, 3) * np.sqrt(half[:, None] * weights).ravel()[:, None]
    return third.T @ third


def _smoothed(rows: np.ndarray, target: np.ndarray, roughness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of least penalised squares, with their covariance; the penalty by generalised cross-validation."""
    square = rows.T @ rows
    size = float(np.trace(square) / np.trace(roughness))
    rough, vectors = eigh(size * roughness, square + size * roughness)
    rough = np.clip(rough, 0.0, 1.0)
    pulled = vectors.T @ (rows.T @ target)
    turned = rows @ vectors

    def gain(smoothing: float) -> np.ndarray:
        return 1.0 / np.maximum(1.0 - rough + smoothing * rough, 1e-300)

    def score(smoothing: float) -> float:
        left = target - turned @ (gain(smoothing) * pulled)
        freedom = float(((1.0 - rough) * gain(smoothing)).sum())
        return float(left @ left) / max(len(target) - freedom, 1.0) ** 2

    best = min(SMOOTHINGS, key=score)
    weight = gain(best)
    left = target - turned @ (weight * pulled)
    variance = float(left @ left) / max(len(target) - float(((1.0 - rough) * weight).sum()), 1.0)
    return vectors @ (weight * pulled), variance * (vectors * weight) @ vectors.T


