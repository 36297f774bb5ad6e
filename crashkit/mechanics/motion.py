"""The record of a run as a Dataset."""

from collections.abc import Hashable, Mapping, Sequence

import numpy as np
import xarray as xr
from xarray.indexes import PandasIndex

from crashkit.mechanics.kernel.arrays import Floats, Record
from crashkit.mechanics.layout import DOF
from crashkit.mechanics.run import normal_of

UNITS = {
    "position": "m",
    "velocity": "m s-1",
    "acceleration": "m s-2",
    "orientation": "1",
    "rotation": "1",
    "angular_velocity": "rad s-1",
    "angular_acceleration": "rad s-2",
    "deformation": "m",
    "deformation_rate": "m s-1",
    "force": "N",
    "contact_force": "N",
    "contact_moment": "N m",
}
BY_BODY = (
    ("position", "rotation"),
    ("velocity", "angular_velocity"),
    ("acceleration", "angular_acceleration"),
    ("contact_force", "contact_moment"),
)
BY_JOINT = ("deformation", "deformation_rate", "force")
XYZ = ("x", "y", "z")


def motion_of(record: Record, times: Floats, axes: tuple[str, ...], names: xr.Coordinates, paths: Sequence[str]) -> xr.Dataset:
    """The motion that a run recorded.

    Arguments:
        record: of the kernel.
        times: s.
        axes: of the model.
        names: coordinates `body`, `axis` and `joint`, and `joint_bodies`.
        paths: the parameters that the sensitivities are to.
    """
    indexes = [_index("time", times, {"units": "s"})]
    if paths:
        indexes.append(_index("parameter", np.array(paths, dtype=str), {}))
    variables = {name: _variable(name, values) for name, values in arrays_of(record, axes, names).items()}
    return xr.Dataset(variables, _extended(names, indexes))


def arrays_of(record: Record, axes: tuple[str, ...], names: xr.Coordinates) -> dict[str, Floats]:
    """The variables of the motion that a run recorded, with their sensitivities where it has any."""
    count = names["joint"].size, names["body"].size
    arrays = recorded(record.values, axes, *count)
    if record.tangents.shape[0]:
        tangents, _ = quantities(record.tangents, axes, *count)
        arrays |= {f"{name}_sensitivity": values for name, values in tangents.items()}
    return arrays


def recorded(values: Floats, axes: tuple[str, ...], joints: int, bodies: int) -> dict[str, Floats]:
    """Quantities (time, body or joint, ...) from the values of a record (time, entry)."""
    arrays, rest = quantities(values, axes, joints, bodies)
    if len(axes) == 3:
        arrays["orientation"] = rest.reshape(len(values), bodies, 4)
    if len(axes) == 2:
        arrays["orientation"] = turned(arrays["rotation"], normal_of(axes))
    arrays.pop("rotation", None)
    return arrays


def quantities(entries: Floats, axes: tuple[str, ...], joints: int, bodies: int) -> tuple[dict[str, Floats], Floats]:
    """Quantities (time, body or joint, ...) from the entries of a record (time, entry, ...), and the entries left over."""
    dof = DOF[len(axes)]
    n = dof * bodies
    quaternions = 4 * bodies if len(axes) == 3 and entries.ndim == 2 else 0
    twice = entries.shape[1] - 3 * joints - n - quaternions
    state, by_joint, net, rest = np.split(entries, np.cumsum([twice, 3 * joints, n]), axis=1)
    arrays = {name: by_joint[:, i::3] for i, name in enumerate(("force", "deformation", "deformation_rate"))}
    parts = (state[:, :n], state[:, n : 2 * n], state[:, twice // 2 + n : twice // 2 + 2 * n], net)
    for (straight, turning), values in zip(BY_BODY, parts, strict=True):
        values = values.reshape(values.shape[0], bodies, dof, *values.shape[2:])
        if len(axes) == 1:
            arrays[straight] = values
        elif len(axes) == 3:
            arrays[straight], arrays[turning] = values[:, :, :3], values[:, :, 3:]
        else:
            arrays[straight], arrays[turning] = _in_space(values, axes)
    return arrays, rest


def _in_space(values: Floats, axes: tuple[str, ...]) -> tuple[Floats, Floats]:
    """The vector along two axes and the one about their normal, (time, body, x y z, ...), of components in the plane."""
    across, straight = normal_of(axes), np.zeros((*values.shape[:2], 3, *values.shape[3:]))
    turning = straight.copy()
    straight[:, :, [XYZ.index(axis) for axis in axes]] = values[:, :, :2]
    about = int(np.flatnonzero(across)[0])
    turning[:, :, about] = across[about] * values[:, :, 2]
    return straight, turning


def turned(rotation: Floats, normal: Floats) -> Floats:
    """The quaternions of rotations about a normal."""
    half = 0.5 * rotation @ normal
    return np.concatenate([np.cos(half)[..., None], np.sin(half)[..., None] * normal], axis=2)


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


def dims_of(name: str) -> tuple[str, ...]:
    """The dims of a quantity or of its sensitivity, after time."""
    quantity = name.removesuffix("_sensitivity")
    columns = ("parameter",) if quantity != name else ()
    return (
        ("joint", *columns)
        if quantity in BY_JOINT
        else ("body", "quaternion" if quantity == "orientation" else "axis", *columns)
    )


def _variable(name: str, values: Floats) -> xr.Variable:
    return xr.Variable(("time", *dims_of(name)), values, {"units": UNITS[name.removesuffix("_sensitivity")]})
