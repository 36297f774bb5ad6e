"""Bodies on rails: their motion is imposed as it was measured."""

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Body, GivenMotion, Model


def on_rails(model: Model, body: Body, motion: xr.Dataset) -> Body:
    """A body of a model that moves as a measured motion says, of which every instant is known."""
    own = motion.sel(body=body.name)
    position = own["position"].sel(axis=list(model.axes)).transpose("time", "axis").values
    times, places = tuple(own["time"].values.tolist()), tuple(map(tuple, position.tolist()))
    imposed = GivenMotion(times, places, _orientations(model, own))
    return evolve(body, mass=None, inertia=(), motion=imposed)


def _orientations(model: Model, own: xr.Dataset) -> tuple[tuple[float, ...], ...]:
    """Quaternions in space, angles in the plane, nothing in one axis."""
    if len(model.axes) == 1:
        return ()
    quaternions = own["orientation"].transpose("time", "quaternion").values
    if len(model.axes) == 3:
        return tuple(map(tuple, quaternions.tolist()))
    first, second = (np.eye(3)["xyz".index(axis)] for axis in model.axes)
    angles = 2.0 * np.arctan2(quaternions[:, 1:] @ np.cross(first, second), quaternions[:, 0])
    return tuple((angle,) for angle in np.unwrap(angles).tolist())
