"""The motion that the instruments of a run saw: for each body one spline through all its film and accelerometers."""

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.errors import CrashkitError
from crashkit.mechanics.motion import XYZ
from crashkit.misfit import Group, Misfit
from crashkit.misfit.predictor import initial_state
from crashkit.model import Body
from crashkit_identifiers.measured_rotation import rotation_curves
from crashkit_identifiers.spline import Reading, enough, smoothed

INITIAL = {"position": 1e-5, "velocity": 1e-4}
"""m, m s-1: how well the state at t = 0 is taken to be known."""
SAME_INSTANT = 1e-9
"""s; readings closer than this are of one instant."""
ORDERS = {"position": 0, "velocity": 1, "acceleration": 2}
UNITS = {
    "position": "m",
    "velocity": "m s-1",
    "acceleration": "m s-2",
    "orientation": "1",
    "angular_velocity": "rad s-1",
    "angular_acceleration": "rad s-2",
}


def measured_motion(misfit: Misfit, run: str) -> xr.Dataset:
    """The motion of every body that an instrument of a run saw, from t = 0.

    Film and accelerometers of a body share one smoothing spline, and so does the state at t = 0 where the recording holds it.
    Instruments' own errors are not taken out. Fixed bodies stay where they are.

    Returns:
        Dataset with `position`, `velocity`, `acceleration` (time, body, axis) and `<each>_std`, NaN for bodies that no
        instrument saw; in several axes, which are then all three, also `orientation` (time, body, quaternion),
        `angular_velocity`, `angular_acceleration` and `angular_acceleration_std`; `seen` (body), whether all of that is known.
    """
    groups = tuple(group for group in misfit.groups if group.run == run)
    bodies = tuple(evolve(body, mass=None, inertia=(), motion=None, force=None) for body in misfit.model.bodies)
    return _measured(misfit.model.axes, bodies, groups, tuple(_initial(misfit, run)))


@lru_cache(maxsize=64)
def _measured(
    model_axes: tuple[str, ...], bodies: tuple[Body, ...], groups: tuple[Group, ...], initial: tuple["_Initial", ...]
) -> xr.Dataset:
    """Remembered: a diagnosis tries many models on the same readings."""
    times = _instants(groups)
    axes = model_axes if len(model_axes) == 1 else XYZ
    parts = []
    for body in bodies:
        position = dict(zip(model_axes, body.position, strict=True))
        columns = [
            _still(position.get(axis, 0.0), len(times))
            if body.fixed or axis not in model_axes
            else _moved(groups, body.name, axis, tuple(one for one in initial if (one.body, one.axis) == (body.name, axis)))
            for axis in axes
        ]
        arrays = {name: np.column_stack([column[name] for column in columns]) for name in columns[0]}
        if len(axes) == 3:
            turns = [(one.reading.times, one.quaternions) for one in _found(groups) if (one.body, one.axis) == (body.name, "")]
            arrays |= rotation_curves(turns, times, body, model_axes)
        parts.append(arrays)
    variables = {
        name: (
            ("time", "body", "quaternion" if name == "orientation" else "axis"),
            np.stack([part[name] for part in parts], axis=1),
            {"units": UNITS[name.removesuffix("_std")]},
        )
        for name in parts[0]
    }
    seen = [all(np.isfinite(values).any() for values in part.values()) for part in parts]
    coords = {"time": times, "body": [body.name for body in bodies], "axis": list(axes)}
    return xr.Dataset({**variables, "seen": ("body", seen)}, coords)


def measured_motions(misfit: Misfit) -> dict[str, xr.Dataset]:
    """The measured motion of every run."""
    return {run: measured_motion(misfit, run) for run in misfit.recordings}


def require_seen(misfit: Misfit, measured: Mapping[str, xr.Dataset], method: str) -> None:
    """Raise CrashkitError where the instruments of a run did not see all of the motion of a body that a joint holds."""
    for run, motion in measured.items():
        missing = unseen(misfit, motion)
        if missing:
            raise CrashkitError(
                f"{run}: {method} needs the measured motion of every body that a joint holds, found none of "
                f"{', '.join(missing)}; a method that simulates, for example sensitivity, does without"
            )


def unseen(misfit: Misfit, motion: xr.Dataset) -> list[str]:
    """The bodies that a joint holds, and that the instruments of a run did not see all of."""
    bodies = dict.fromkeys(body for joint in misfit.model.joints for body in joint.bodies)
    seen = dict(zip(motion["body"].values.tolist(), motion["seen"].values.tolist(), strict=True))
    return [body for body in bodies if not seen[body]]


def known(motion: xr.Dataset) -> xr.Dataset:
    """The motion without the instants at which something of it is not known."""
    return motion.isel(time=np.isfinite(motion["acceleration"].values).all(axis=(1, 2)))


def weights(std: np.ndarray) -> np.ndarray:
    """One over the typical standard deviation of each column (time, ...); 0 where that is 0."""
    size = np.sqrt(np.mean(std**2, axis=0))
    return np.divide(1.0, size, out=np.zeros_like(size), where=size > 0.0)


def thinned(motion: xr.Dataset, count: int) -> xr.Dataset:
    """The motion at every so many instants, about `count` of them."""
    return motion.isel(time=slice(None, None, max(1, round(motion.sizes["time"] / count))))


def instants(misfit: Misfit, run: str) -> np.ndarray:
    """Every instant from t = 0 at which an instrument of the run reads something."""
    return _instants([group for group in misfit.groups if group.run == run])


def _instants(groups: Sequence[Group]) -> np.ndarray:
    stamps = np.concatenate([[0.0], *(group.times for group in groups)])
    stamps = np.unique(stamps[stamps >= 0.0])
    return stamps[np.concatenate([[True], np.diff(stamps) > SAME_INSTANT])]


@frozen(eq=False)
class _Found:
    """Readings of one body along one axis; of its orientation, with no axis, the quaternions."""

    body: str
    axis: str
    reading: Reading
    quaternions: np.ndarray = np.empty((0, 4))


@lru_cache(maxsize=16)
def _found(groups: tuple[Group, ...]) -> tuple[_Found, ...]:
    return tuple(found for group in groups for found in _found_in(group))


def _found_in(group: Group) -> Iterator[_Found]:
    seen = group.motion()
    if seen is None:
        return
    late = group.times >= 0.0
    for quantity in (name for name in ORDERS if name in seen):
        table = seen[quantity].transpose("time", "body", "axis")
        for body in table["body"].values.tolist():
            for axis in table["axis"].values.tolist():
                yield _Found(body, axis, _reading(group, quantity, body, axis, table.sel(body=body, axis=axis).values))
    if "orientation" in seen:
        for body in seen["body"].values.tolist():
            turns = seen["orientation"].sel(body=body).transpose("time", "quaternion").values
            keep = late & np.isfinite(turns).all(axis=1)
            yield _Found(body, "", Reading(0, group.times[keep], np.empty(0), 1.0), turns[keep])


def _reading(group: Group, quantity: str, body: str, axis: str, values: np.ndarray) -> Reading:
    """The mean of the sensors on a body; filtered channels are thinned to independent samples."""
    carriers = [str(name) for name in group.dataset[f"{group.observer.channel}_body"].values]
    body_of = dict(zip([str(name) for name in group.dataset[group.observer.channel].values], carriers, strict=True))
    noises = [c.noise for c in group.channels if body_of[c.sensor] == body and c.axis == axis]
    noises = noises or [c.noise for c in group.channels if body_of[c.sensor] == body]
    std = float(np.sqrt(sum(noise.std**2 for noise in noises))) / len(noises)
    every = max(1, round(max(noise.correlation for noise in noises)))
    keep = np.flatnonzero(np.isfinite(values) & (group.times >= 0.0))[::every]
    return Reading(ORDERS[quantity], group.times[keep], values[keep], std)


@frozen
class _Initial:
    """One number of the state at t = 0."""

    body: str
    axis: str
    quantity: str
    value: float


def _initial(misfit: Misfit, run: str) -> Iterator[_Initial]:
    state = initial_state(misfit.recordings[run], misfit.model)
    if state is None:
        return
    bodies, axes = state["body"].values.tolist(), state["axis"].values.tolist()
    for name in INITIAL:
        values = state[name].transpose("body", "axis").values.tolist()
        for body, of_body in zip(bodies, values, strict=True):
            for axis, value in zip(axes, of_body, strict=True):
                yield _Initial(body, axis, name, value)


Curves = dict[str, np.ndarray]
"""Position, velocity and acceleration along one axis, with their standard deviations."""


@lru_cache(maxsize=256)
def _moved(groups: tuple[Group, ...], body: str, axis: str, initial: tuple[_Initial, ...]) -> Curves:
    """NaN where no instrument saw it. Remembered: a diagnosis tries many models on the same readings."""
    readings = [found.reading for found in _found(groups) if (found.body, found.axis) == (body, axis)]
    readings += [Reading(ORDERS[i.quantity], np.zeros(1), np.full(1, i.value), INITIAL[i.quantity]) for i in initial]
    times = _instants(groups)
    if not enough(readings):
        return _named([(np.full(len(times), np.nan),) * 2] * 3)
    return _named(smoothed(readings, times))


def _still(value: float, count: int) -> Curves:
    return _named([(np.full(count, one), np.zeros(count)) for one in (value, 0.0, 0.0)])


def _named(curves: Sequence[tuple[np.ndarray, np.ndarray]]) -> Curves:
    pairs = zip(ORDERS, curves, strict=True)
    return {name: values for quantity, (mean, std) in pairs for name, values in ((quantity, mean), (f"{quantity}_std", std))}
