"""The record of a run as a Dataset."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from crashkit.mechanics.arrays import Floats, Record, Structure

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


def motion_of(record: Record, structure: Structure, times: Floats, names: xr.Coordinates, paths: Sequence[str]) -> xr.Dataset:
    """The motion that a run recorded.

    Arguments:
        record: of the kernel.
        structure: the bodies and joints of the run.
        times: s.
        names: coordinates `body`, `axis` and `joint`, and `joint_bodies`.
        paths: the parameters that the sensitivities are to.
    """
    incidence = np.zeros((structure.inverse_mass.size, structure.first.size))
    joints = np.arange(structure.first.size)
    incidence[structure.first, joints] -= structure.direction
    incidence[structure.second, joints] += structure.direction
    arrays = record._asdict() | {"contact_force": record.force @ incidence.T}
    wanted = list(UNITS)
    if paths:
        arrays["contact_force_sensitivity"] = incidence @ record.force_sensitivity
        wanted += [f"{name}_sensitivity" for name in UNITS if name != "deformation_rate"]
    coordinates = names.assign(time=xr.Variable("time", times, {"units": "s"}))
    if paths:
        coordinates = coordinates.assign(parameter=list(paths))
    return xr.Dataset({name: _variable(name, arrays[name]) for name in wanted}, coordinates)


def _variable(name: str, values: Floats) -> xr.Variable:
    quantity = name.removesuffix("_sensitivity")
    columns = ("parameter",) if quantity != name else ()
    if quantity in BY_BODY:
        values = values[:, :, np.newaxis]
        return xr.Variable(("time", "body", "axis", *columns), values, {"units": UNITS[quantity]})
    return xr.Variable(("time", "joint", *columns), values, {"units": UNITS[quantity]})
