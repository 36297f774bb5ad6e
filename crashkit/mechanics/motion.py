"""The record of a run as a Dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from crashkit.mechanics.arrays import Floats, Record, Records

UNITS = {
    "position": "m",
    "velocity": "m s-1",
    "acceleration": "m s-2",
    "deformation": "m",
    "deformation_rate": "m s-1",
    "force": "N",
    "contact_force": "N",
}
BY_BODY = ("position", "velocity", "acceleration", "contact_force")
BY_JOINT = ("deformation", "deformation_rate", "force")


def motion_of(record: Record, joints: Records, times: Floats, names: xr.Coordinates, paths: Sequence[str]) -> xr.Dataset:
    """The motion that a run recorded.

    Arguments:
        record: of the kernel.
        joints: of the run.
        times: s.
        names: coordinates `body`, `axis` and `joint`, and `joint_bodies`.
        paths: the parameters that the sensitivities are to.
    """
    incidence = np.zeros((record.state.shape[2], joints.size))
    incidence[joints["first"], np.arange(joints.size)] -= joints["direction"]
    incidence[joints["second"], np.arange(joints.size)] += joints["direction"]
    arrays = dict(zip(BY_BODY[:3], np.moveaxis(record.state, 1, 0), strict=True))
    arrays |= zip(BY_JOINT, np.moveaxis(record.joints, 1, 0), strict=True)
    arrays["contact_force"] = arrays["force"] @ incidence.T
    coordinates = names.assign(time=xr.Variable("time", times, {"units": "s"}))
    if paths:
        coordinates = coordinates.assign(parameter=list(paths))
        force, deformation = np.moveaxis(record.joint_tangent, 1, 0)
        sensitivities = dict(zip(BY_BODY[:3], np.moveaxis(record.tangent, 1, 0), strict=True))
        sensitivities |= {"contact_force": incidence @ force, "force": force, "deformation": deformation}
        arrays |= {f"{name}_sensitivity": values for name, values in sensitivities.items()}
    return xr.Dataset({name: _variable(name, values) for name, values in arrays.items()}, coordinates)


def _variable(name: str, values: Floats) -> xr.Variable:
    quantity = name.removesuffix("_sensitivity")
    columns = ("parameter",) if quantity != name else ()
    if quantity in BY_BODY:
        values = values[:, :, np.newaxis]
        return xr.Variable(("time", "body", "axis", *columns), values, {"units": UNITS[quantity]})
    return xr.Variable(("time", "joint", *columns), values, {"units": UNITS[quantity]})
