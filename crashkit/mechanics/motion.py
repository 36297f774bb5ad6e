"""The record of a run as a Dataset."""

from collections.abc import Hashable, Mapping, Sequence

import numpy as np
import xarray as xr
from xarray.indexes import PandasIndex

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
    indexes = [_index("time", times, {"units": "s"})]
    if paths:
        indexes.append(_index("parameter", np.array(paths, dtype=str), {}))
        force, deformation = np.moveaxis(record.joint_tangent, 1, 0)
        sensitivities = dict(zip(BY_BODY[:3], np.moveaxis(record.tangent, 1, 0), strict=True))
        sensitivities |= {"contact_force": incidence @ force, "force": force, "deformation": deformation}
        arrays |= {f"{name}_sensitivity": values for name, values in sensitivities.items()}
    variables = {name: _variable(name, values) for name, values in arrays.items()}
    return xr.Dataset(variables, _extended(names, indexes))


def _index(name: str, values: np.ndarray, attributes: Mapping[str, str]) -> tuple[PandasIndex, dict[Hashable, xr.Variable]]:
    index = PandasIndex(values, name)
    return index, dict(index.create_variables({name: xr.Variable(name, values, attributes)}))


def _extended(names: xr.Coordinates, indexes: Sequence[tuple[PandasIndex, dict[Hashable, xr.Variable]]]) -> xr.Coordinates:
    """More coordinates, with the indexes of the others as they are: to make those again costs more than a short run."""
    variables, known = dict(names.variables), dict(names.xindexes)
    for index, made in indexes:
        variables |= made
        known |= dict.fromkeys(made, index)
    return xr.Coordinates(variables, known)


def _variable(name: str, values: Floats) -> xr.Variable:
    quantity = name.removesuffix("_sensitivity")
    columns = ("parameter",) if quantity != name else ()
    if quantity in BY_BODY:
        values = values[:, :, np.newaxis]
        return xr.Variable(("time", "body", "axis", *columns), values, {"units": UNITS[quantity]})
    return xr.Variable(("time", "joint", *columns), values, {"units": UNITS[quantity]})
