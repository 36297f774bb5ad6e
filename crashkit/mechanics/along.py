"""The forces of a model's joints along a motion that was not simulated with it: recorded, or of another model."""

import numpy as np
import xarray as xr

from crashkit.mechanics.joint_track import load_on, tracks_of
from crashkit.mechanics.motion import UNITS, dims_of
from crashkit.model import Model
from crashkit.protocols import Laws


def forces_along(model: Model, laws: Laws, motion: xr.Dataset) -> xr.Dataset:
    """What the joints would push with if the bodies moved like this (Mizzi & Jezequel 1992, eq 7-11).

    Arguments:
        model: in one, two or three axes; what its laws remember is nothing at the first instant of the motion.
        laws: installed laws and factors by name.
        motion: `position` and `velocity` (time, body, axis), m and m s-1, of all the bodies that joints hold; in several
            axes, which are then all three, also `orientation` and `angular_velocity`, rad s-1.

    Returns:
        Dataset with `deformation`, `deformation_rate`, `force` (time, joint), m, m s-1 and N, and `contact_force`
        (time, body, axis), N, the net force of the joints on each body; in several axes also `contact_moment`, N m.

    Raises:
        CrashkitError: a law is not installed, or runs as plain Python.
    """
    tracks, times = tracks_of(model, laws, motion), motion["time"].values
    values = model.values()
    columns = np.array([[*track.states(values)[:, :2].T, track.force(values)] for track in tracks])
    deformation, rate, force = columns.reshape(-1, 3, len(times)).transpose(1, 2, 0)
    load = load_on(np.zeros((len(times), len(model.bodies), 1 if len(model.axes) == 1 else 6)), tracks, force.T)
    arrays = {"deformation": deformation, "deformation_rate": rate, "force": force, "contact_force": load[:, :, :3]}
    if len(model.axes) > 1:
        arrays["contact_moment"] = load[:, :, 3:]
    coords = {
        "time": times,
        "joint": [joint.name for joint in model.joints],
        "body": [body.name for body in model.bodies],
        "axis": motion["axis"].values,
    }
    variables = {name: (("time", *dims_of(name)), array, {"units": UNITS[name]}) for name, array in arrays.items()}
    return xr.Dataset(variables, coords)
