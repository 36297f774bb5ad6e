"""How far a sensor leans out of the axis of a model on a line, as its other axes tell: they read a share of what that does."""

from collections.abc import Iterator, Sequence

import numpy as np
import xarray as xr

from crashkit.registry import load
from crashkit_hypotheses.sensors import Sensor

SHARED = 0.5
"""Of what the other axes read, squared, that must be a share of what the first does: on a body that pitches, they read
more of their own."""


def lean_across(sensor: Sensor, axis: str, recordings: Sequence[xr.DataTree]) -> float:
    """The angle between the axis of a model and that of the sensor, rad; 0 where its other axes, if it has any, do not tell.

    tan(angle) = |t|, where t (across) minimises sum |a_across - t a_axis|^2, offsets aside.
    """
    readings = list(_readings(sensor, axis, recordings)) if axis in sensor.axes and len(sensor.axes) > 1 else []
    if not readings:
        return 0.0
    along, across = (np.concatenate(part) for part in zip(*readings, strict=True))
    shares = along @ across / max(float(along @ along), np.finfo(float).tiny)
    left = across - np.outer(along, shares)
    is_shared = np.sum(left**2) < (1.0 - SHARED) * np.sum(across**2)
    return float(np.arctan(np.linalg.norm(shares))) if is_shared else 0.0


def _readings(sensor: Sensor, axis: str, recordings: Sequence[xr.DataTree]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Along that axis (time,) and the others (time, axis) of each recording, offsets taken away."""
    for recording in (one for one in recordings if sensor.instrument in one.children):
        group = recording.children[sensor.instrument].to_dataset(inherit=False)
        if sensor.name not in group.get("sensor", ()) or tuple(group["axis"].values.tolist()) != sensor.axes:
            continue
        quantity = load().observers[str(group.attrs["observer"])].quantity
        read = group[quantity].sel(sensor=sensor.name).transpose("time", "axis").dropna("time")
        read = read - read.mean("time")
        yield read.sel(axis=axis).values, read.drop_sel(axis=axis).values
