"""The record of a run as a Dataset."""

from collections.abc import Hashable, Mapping, Sequence

import numpy as np
import xarray as xr
from xarray.indexes import PandasIndex

from crashkit.mechanics.arrays import REST, Floats, Record, Work

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


def motion_of(record: Record, work: Work, times: Floats, names: xr.Coordinates, paths: Sequence[str]) -> xr.Dataset:
    """The motion that a run recorded.

    Arguments:
        record: of the kernel.
        work: the arrays of the run.
        times: s.
        names: coordinates `body`, `axis` and `joint`, and `joint_bodies`.
        paths: the parameters that the sensitivities are to.
    """
    joints, count = work.joints, work.bodies.size
    incidence = np.zeros((count, joints.size))
    incidence[joints["first"], np.arange(joints.size)] -= joints["direction"]
    incidence[joints["second"], np.arange(joints.size)] += joints["direction"]
    position, velocity, acceleration = (record.state[:, start : start + count] for start in (0, count, 2 * count))
    arrays = {
        "position": position,
        "velocity": velocity,
        "acceleration": acceleration,
        "deformation": joints["rest"] - position @ incidence,
        "deformation_rate": -velocity @ incidence,
        "force": record.force,
        "contact_force": record.force @ incidence.T,
    }
    indexes = [_index("time", times, {"units": "s"})]
    if paths:
        indexes.append(_index("parameter", np.array(paths, dtype=str), {}))
        position, velocity, acceleration = (record.tangent[:, start : start + count] for start in (0, count, 2 * count))
        arrays |= {
            "position_sensitivity": position,
            "velocity_sensitivity": velocity,
            "acceleration_sensitivity": acceleration,
            "contact_force_sensitivity": incidence @ record.force_tangent,
            "force_sensitivity": record.force_tangent,
            "deformation_sensitivity": work.joint_tangent[:, REST] - incidence.T @ position,
        }
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
