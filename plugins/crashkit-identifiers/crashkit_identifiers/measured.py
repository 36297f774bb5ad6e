"""The motion that the instruments of a run saw: for each body one spline through all its film and accelerometers."""

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.errors import CrashkitError
from crashkit.misfit import Group, Misfit
from crashkit.misfit.predictor import initial_state
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
    model, times = misfit.model, instants(misfit, run)
    found = list(_found(misfit, run))
    axes = model.axes if len(model.axes) == 1 else XYZ
    parts = []
    for body in model.bodies:
        own = [reading for reading in found if reading.body == body.name]
        position = dict(zip(model.axes, body.position, strict=True))
        still = {axis: position.get(axis, 0.0) if body.fixed or axis not in model.axes else None for axis in axes}
        columns = [_curves([r.reading for r in own if r.axis == axis], times, still[axis]) for axis in axes]
        arrays = {name: np.column_stack([column[name] for column in columns]) for name in columns[0]}
        if len(axes) == 3:
            arrays |= rotation_curves([(r.reading.times, r.quaternions) for r in own if r.axis == ""], times, body, model.axes)
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
    coords = {"time": times, "body": [body.name for body in model.bodies], "axis": list(axes)}
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
    stamps = np.concatenate([[0.0], *(group.times for group in misfit.groups if group.run == run)])
    stamps = np.unique(stamps[stamps >= 0.0])
    return stamps[np.concatenate([[True], np.diff(stamps) > SAME_INSTANT])]


@frozen(eq=False)
class _Found:
    """Readings of one body along one axis; of its orientation, with no axis, the quaternions."""

    body: str
    axis: str
    reading: Reading
    quaternions: np.ndarray = np.empty((0, 4))


def _found(misfit: Misfit, run: str) -> Iterator[_Found]:
    for group in (g for g in misfit.groups if g.run == run):
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
    yield from _initial(misfit, run)


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


def _initial(misfit: Misfit, run: str) -> Iterator[_Found]:
    state = initial_state(misfit.recordings[run], misfit.model)
    if state is None:
        return
    for name, std in INITIAL.items():
        for body in state["body"].values.tolist():
            for axis in state["axis"].values.tolist():
                value = state[name].sel(body=body, axis=axis).values.reshape(1)
                yield _Found(body, axis, Reading(ORDERS[name], np.zeros(1), value, std))


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
