"""What views would have recorded if their clocks were the same."""

import numpy as np
import xarray as xr

from crashkit_cameras.synchronise.clocks import corrected_time

NODES = 4


def resampled(instrument: xr.Dataset, clock: xr.Dataset) -> xr.Dataset:
    """A camera group whose views all see the markers at the times of `time`, as triangulation needs it.

    Each image is on the cubic through the four frames about its time. A place is missing where one of these is, and outside
    the film of a view.

    Arguments:
        instrument: a camera group, `time` the stamps of all views.
        clock: of its views, from `synchronise_views` or `synchronise_by_diode`.

    Raises CrashkitError where a clock could not be determined.
    """
    wanted = instrument["time"].values
    taken = corrected_time(instrument["time"], clock).transpose("view", "time").values
    position = instrument["image_position"].transpose("view", "time", "marker", "image_axis")
    moved = np.stack([_interpolated(*one, wanted) for one in zip(taken, position.values, strict=True)])
    return instrument.assign(image_position=position.copy(data=moved).transpose("time", "view", "marker", "image_axis"))


def _interpolated(times: np.ndarray, values: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Values (time, ...) at other times by Lagrange's polynomial of third degree, NaN outside."""
    first = np.clip(np.searchsorted(times, wanted) - NODES // 2, 0, len(times) - NODES)
    rows = first[:, None] + np.arange(NODES)
    nodes = times[rows]
    weights = np.ones_like(nodes)
    for node in range(NODES):
        for other in set(range(NODES)) - {node}:
            weights[:, node] *= (wanted - nodes[:, other]) / (nodes[:, node] - nodes[:, other])
    weights[np.abs(weights) < 1e-9] = 0.0
    terms = np.where(weights.reshape(*weights.shape, *(1,) * (values.ndim - 1)) == 0.0, 0.0, values[rows])
    found = np.einsum("tn,tn...->t...", weights, terms)
    found[(wanted < times[0] - 1e-12) | (wanted > times[-1] + 1e-12)] = np.nan
    return found
