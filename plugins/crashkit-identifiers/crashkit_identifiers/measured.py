"""The motion that the instruments of a run saw: for each body one spline through all its film and accelerometers."""

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.errors import CrashkitError
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
XYZ = ("x", "y", "z")


def measured_motion(misfit: Misfit, run: str) -> xr.Dataset:
    """The motion of every body that an instrument of a run saw, from t = 0.

    Film and accelerometers of a body share one smoothing spline, and so does the state at t = 0 where the recording holds it.
    Instruments' own errors are not taken out. Fixed bodies stay where they are.

    Returns:
        Dataset with `position`, `velocity`, `acceleration` (time, body, axis) and `<each>_std`, NaN for bodies that no
        instrument saw; in several axes, which are then all three, also `orientation` (time, body, quaternion),
        `angular_velocity`, `angular_acceleration` and `angular_acceleration_std`; `seen` (body), whether all of that is known.
    """
    model, groups = misfit.model, tuple(group for group in misfit.groups if group.run == run)
    return _measured(groups, tuple(_initial(misfit, run)), model.bodies, model.axes)


@lru_cache(maxsize=32)
def _measured(
    groups: tuple[Group, ...], initial: tuple["_Initial", ...], bodies: tuple[Body, ...], model_axes: tuple[str, ...]
) -> xr.Dataset:
    """Remembered, because many models are tried on the same readings."""
    times = _instants(groups)
    found = [*_found(groups), *(one.reading for one in initial)]
    axes = model_axes if len(model_axes) == 1 else XYZ
    parts = []
    for body in bodies:
        own = [reading for reading in found if reading.body == body.name]
        position = dict(zip(model_axes, body.position, strict=True))
        still = {axis: position.get(axis, 0.0) if body.fixed or axis not in model_axes else None for axis in axes}
        columns = [_curves([r.reading for r in own if r.axis == axis], times, still[axis]) for axis in axes]
        arrays = {name: np.column_stack([column[name] for column in columns]) for name in columns[0]}
        if len(axes) == 3:
            arrays |= rotation_curves([(r.reading.times, r.quaternions) for r in own if r.axis == ""], times, body, model_axes)
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
    bodies = list(dict.fromkeys(body for joint in misfit.model.joints for body in joint.bodies))
    for run, motion in measured.items():
        missing = [body for body in bodies if not bool(motion["seen"].sel(body=body))]
        if missing:
            raise CrashkitError(
                f"{run}: {method} needs the measured motion of every body that a joint holds, found none of "
                f"{', '.join(missing)}; a method that simulates, for example sensitivity, does without"
            )


def known(motion: xr.Dataset) -> xr.Dataset:
    """The motion without the instants at which something of it is not known."""
    return motion.isel(time=np.isfinite(motion["acceleration"].values).all(axis=(1, 2)))


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


@frozen
class _Initial:
    """One number of the state at t = 0, and what it is."""

    body: str
    axis: str
    quantity: str
    value: float

    @property
    def reading(self) -> _Found:
        known = Reading(ORDERS[self.quantity], np.zeros(1), np.full(1, self.value), INITIAL[self.quantity])
        return _Found(self.body, self.axis, known)


def _found(groups: Sequence[Group]) -> Iterator[_Found]:
    for group in groups:
        seen = group.observer.reconstruct(group.dataset)
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


def _initial(misfit: Misfit, run: str) -> Iterator[_Initial]:
    state = initial_state(misfit.recordings[run], misfit.model)
    if state is None:
        return
    for name in INITIAL:
        for body in state["body"].values.tolist():
            for axis in state["axis"].values.tolist():
                yield _Initial(body, axis, name, float(state[name].sel(body=body, axis=axis)))


def _curves(readings: list[Reading], times: np.ndarray, still: float | None) -> dict[str, np.ndarray]:
    """Position, velocity and acceleration along one axis, with their standard deviations; NaN where no instrument saw them."""
    if still is not None:
        curves = [(np.full(len(times), value), np.zeros(len(times))) for value in (still, 0.0, 0.0)]
    elif enough(readings):
        curves = smoothed(readings, times)
    else:
        curves = [(np.full(len(times), np.nan),) * 2] * 3
    return {
        name: values
        for quantity, pair in zip(ORDERS, curves, strict=True)
        for name, values in zip((quantity, f"{quantity}_std"), pair, strict=True)
    }
