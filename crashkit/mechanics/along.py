"""The forces of a model's joints along a motion that was not simulated with it: recorded, or of another model."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import SpringLaw


def forces_along(model: Model, laws: Mapping[str, type[SpringLaw]], motion: xr.Dataset) -> xr.Dataset:
    """What the joints would push with if the bodies moved like this.

    Arguments:
        model: one axis.
        laws: installed laws and factors by name.
        motion: `position` and `velocity` (time, body, axis), m and m s-1, of all the bodies that joints hold.

    Returns:
        Dataset with `deformation`, `deformation_rate`, `force` (time, joint), m, m s-1 and N, and `contact_force`
        (time, body, axis), N, the net force of the joints on each body.
    """
    names = [body.name for body in model.bodies]
    net = np.zeros((motion.sizes["time"], len(names)))
    columns: dict[str, list[np.ndarray]] = {"deformation": [], "deformation_rate": [], "force": []}
    for joint in model.joints:
        first, second = joint.bodies
        side = _side(model, joint)
        deformation, rate = _deformation(model, joint, side, motion)
        force = _force(joint, laws, deformation, rate)
        for name, column in zip(columns, (deformation, rate, force), strict=True):
            columns[name].append(column)
        net[:, names.index(first)] -= side * force
        net[:, names.index(second)] += side * force
    units = {"deformation": "m", "deformation_rate": "m s-1", "force": "N"}
    shape = (len(model.joints), motion.sizes["time"])
    variables: dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]] = {
        name: (("time", "joint"), np.array(column).reshape(shape).T, {"units": units[name]})
        for name, column in columns.items()
    }
    variables["contact_force"] = (("time", "body", "axis"), net[:, :, None], {"units": "N"})
    coords = {"time": motion["time"].values, "joint": [j.name for j in model.joints], "body": names, "axis": list(model.axes)}
    return xr.Dataset(variables, coords=coords)


def _side(model: Model, joint: Joint) -> float:
    first, second = (model.body(name).position[0] for name in joint.bodies)
    points = joint.points or ((0.0,), (0.0,))
    return 1.0 if second + points[1][0] >= first + points[0][0] else -1.0


def _deformation(model: Model, joint: Joint, side: float, motion: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    first, second = (motion.sel(body=name).isel(axis=0) for name in joint.bodies)
    points = joint.points or ((0.0,), (0.0,))
    length = side * (second["position"].values + points[1][0] - first["position"].values - points[0][0])
    free_length = length[0] if joint.free_length is None else joint.free_length.value
    return free_length - length, -side * (second["velocity"].values - first["velocity"].values)


def _force(joint: Joint, laws: Mapping[str, type[SpringLaw]], deformation: np.ndarray, rate: np.ndarray) -> np.ndarray:
    largest = np.maximum.accumulate(np.maximum(deformation, 0.0))
    force = np.ones(len(deformation))
    for law in (laws[name] for name in (joint.law, *joint.factors)):
        values = [_value(joint.parameters.get(spec.name), spec.default) for spec in law.parameters]
        force *= [
            law.force(d, v, m, *values) for d, v, m in zip(deformation.tolist(), rate.tolist(), largest.tolist(), strict=True)
        ]
    return force


def _value(parameter: Parameter | tuple[Parameter, ...] | None, default: float | None) -> object:
    if parameter is None:
        return default
    return parameter.value if isinstance(parameter, Parameter) else [entry.value for entry in parameter]
