"""The forces of a model's joints along a motion that was not simulated with it: recorded, or of another model."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.spatial.transform import Rotation

from crashkit.mechanics.given import side_of
from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import SpringLaw

Laws = Mapping[str, type[SpringLaw]]
Vectors = tuple[np.ndarray, np.ndarray]
"""Something and its rate, or what is at either end of a joint; each (time, axis)."""


@frozen
class Path:
    """How a motion deforms a joint.

    Attributes:
        times: (time,), s.
        deformation, rate: (time,), m and m s-1.
        direction: (time, axis), in which the second body is pushed.
        arms: (time, axis) each, m, from the centres of mass to where the joint holds.
        driver: how it deforms the joint that drives this one, if one does.
    """

    times: np.ndarray
    deformation: np.ndarray
    rate: np.ndarray
    direction: np.ndarray
    arms: Vectors
    driver: "Path | None" = None


def forces_along(model: Model, laws: Laws, motion: xr.Dataset) -> xr.Dataset:
    """What the joints would push with if the bodies moved like this (Mizzi & Jezequel 1992, eq 7-11).

    Arguments:
        model: in one, two or three axes.
        laws: installed laws and factors by name.
        motion: `position` and `velocity` (time, body, axis), m and m s-1, of all the bodies that joints hold; in several
            axes also `orientation` and `angular_velocity` (rad s-1), without which the bodies do not turn.

    Returns:
        Dataset with `deformation`, `deformation_rate`, `force` (time, joint), m, m s-1 and N, and `contact_force`
        (time, body, axis), N, the net force of the joints on each body; in several axes also `contact_moment`, N m.
    """
    axes = list(motion["axis"].values)
    paths = [path_along(model, joint, motion) for joint in model.joints]
    forces = [force_along(joint, laws, path) for joint, path in zip(model.joints, paths, strict=True)]
    shape = (len(paths), motion.sizes["time"])
    columns = {
        "deformation": ([path.deformation for path in paths], "m"),
        "deformation_rate": ([path.rate for path in paths], "m s-1"),
        "force": (forces, "N"),
    }
    variables: dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]] = {
        name: (("time", "joint"), np.array(column).reshape(shape).T, {"units": units})
        for name, (column, units) in columns.items()
    }
    pushes = [force[:, None] * path.direction for force, path in zip(forces, paths, strict=True)]
    dims, still = ("time", "body", "axis"), np.zeros((motion.sizes["time"], len(model.bodies), len(axes)))
    variables["contact_force"] = (dims, on_bodies(model, still, [(push, push) for push in pushes]), {"units": "N"})
    if len(axes) == 3:
        turns = [
            (np.cross(path.arms[0], push), np.cross(path.arms[1], push)) for path, push in zip(paths, pushes, strict=True)
        ]
        variables["contact_moment"] = (dims, on_bodies(model, still, turns), {"units": "N m"})
    coords = {
        "time": motion["time"].values,
        "joint": [joint.name for joint in model.joints],
        "body": [body.name for body in model.bodies],
        "axis": axes,
    }
    return xr.Dataset(variables, coords=coords)


def on_bodies(model: Model, still: np.ndarray, ends: Sequence[Vectors]) -> np.ndarray:
    """The sum of what the joints do to each body.

    Arguments:
        still: (time, body, axis), where nothing does anything.
        ends: of each joint what it does to its second body, and the opposite of what it does to its first, at their ends.
    """
    names, net = [body.name for body in model.bodies], still.copy()
    for joint, (near, far) in zip(model.joints, ends, strict=True):
        net[:, names.index(joint.pushed[0])] -= near
        net[:, names.index(joint.pushed[1])] += far
    return net


def path_along(model: Model, joint: Joint, motion: xr.Dataset) -> Path:
    """How a motion deforms a joint of the model."""
    points = joint.points or ((0.0,) * len(model.axes),) * 2
    (near, near_rate), (far, far_rate) = (
        _carried(model, motion, name, point) for name, point in zip(joint.bodies, points, strict=True)
    )
    apart, apart_rate = far - near, far_rate - near_rate
    centres = [motion["position"].sel(body=name).values for name in joint.bodies]
    if joint.normal is not None:
        direction, turning = _turned(model, motion, joint.bodies[0], joint.normal)
        length = np.sum(direction * apart, axis=1)
        rate = np.sum(turning * apart + direction * apart_rate, axis=1)
        arms = far - centres[0], far - centres[1]
    else:
        direction = _directions(model, joint, apart)
        length = np.sum(direction * apart, axis=1)
        rate = np.sum(direction * apart_rate, axis=1)
        arms = near - centres[0], far - centres[1]
    free_length = length[0] if joint.free_length is None else joint.free_length.value
    driver = path_along(model, model.joint(joint.driver), motion) if joint.driver else None
    return Path(motion["time"].values, free_length - length, -rate, direction, arms, driver)


def _directions(model: Model, joint: Joint, apart: np.ndarray) -> np.ndarray:
    if len(model.axes) > 1:
        return apart / np.linalg.norm(apart, axis=1, keepdims=True)
    return np.full_like(apart, side_of(model, joint))


def _carried(model: Model, motion: xr.Dataset, body: str, point: tuple[float, ...]) -> Vectors:
    """Where a point of a body is, and how fast it moves."""
    own = motion.sel(body=body)
    arm, rate = _turned(model, motion, body, point)
    return own["position"].values + arm, own["velocity"].values + rate


def _turned(model: Model, motion: xr.Dataset, body: str, vector: tuple[float, ...]) -> Vectors:
    """A vector of a body's frame in the laboratory's, and its rate."""
    axes = motion["axis"].values.tolist()
    row = np.zeros(len(axes))
    row[[axes.index(axis) for axis in model.axes]] = vector
    rows = np.tile(row, (motion.sizes["time"], 1))
    if "orientation" not in motion:
        return rows, np.zeros_like(rows)
    own = motion.sel(body=body)
    rows = Rotation.from_quat(own["orientation"].values, scalar_first=True).apply(rows)
    return rows, np.cross(own["angular_velocity"].values, rows)


def force_along(joint: Joint, laws: Laws, path: Path) -> np.ndarray:
    """What a joint pushes with along a path, (time,), N."""
    own, force = _states(path), np.ones(len(path.times))
    for law in (laws[name] for name in (joint.law, *joint.factors)):
        values = [_value(joint.parameters.get(spec.name), spec.default) for spec in law.parameters]
        states = _states(path.driver) if law.driven and path.driver else own
        if law.memory:
            remembered = _memory(law, path.times, states, values)
            force *= [law.force(*state, z, *values) for state, z in zip(states, remembered, strict=True)]
        else:
            force *= [law.force(*state, *values) for state in states]
    return force


def _states(path: Path) -> list[tuple[float, float, float]]:
    largest = np.maximum.accumulate(np.maximum(path.deformation, 0.0))
    return list(zip(path.deformation.tolist(), path.rate.tolist(), largest.tolist(), strict=True))


def _memory(
    law: type[SpringLaw], times: np.ndarray, states: list[tuple[float, float, float]], values: list[object]
) -> list[float]:
    """A law's memory from 0 at the first sample, by Heun's rule."""
    memory = [0.0]
    for step, (now, then) in zip(np.diff(times).tolist(), pairwise(states), strict=True):
        slope = law.memory_rate(*now, memory[-1], *values)
        memory.append(memory[-1] + 0.5 * step * (slope + law.memory_rate(*then, memory[-1] + step * slope, *values)))
    return memory


def _value(parameter: Parameter | tuple[Parameter, ...] | None, default: float | None) -> object:
    if parameter is None:
        return default
    return parameter.value if isinstance(parameter, Parameter) else [entry.value for entry in parameter]
