"""One joint along a given motion: its deformation, where it pushes, and how hard."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.spatial.transform import Rotation

from crashkit.mechanics.joint_law import JointLaw
from crashkit.mechanics.kernel.arrays import TO_D, TO_D_MAX, TO_MEMORY, Integers
from crashkit.model import Joint, Model

XYZ = ("x", "y", "z")


@frozen(eq=False)
class Track:
    """The force of a joint along a motion, and its derivatives.

    Arguments:
        law: what gives them.
        times: (time,) s.
        distance, nearest: (time,) m, of its ends, and the least so far.
        rate: (time,) m s-1, of its deformation.
        length: m, its free length where the values do not give it.
        ends: of both bodies, the row, and (time, axis) what a force of 1 N puts on it: a force and, in several axes, a moment.
    """

    law: JointLaw
    times: np.ndarray
    distance: np.ndarray
    nearest: np.ndarray
    rate: np.ndarray
    length: float
    ends: tuple[tuple[int, np.ndarray], tuple[int, np.ndarray]]

    def states(self, values: Mapping[str, float]) -> np.ndarray:
        """(time, 3), deformation, its rate, and the largest deformation so far."""
        length = values.get(self._free_length, self.length)
        return np.column_stack([length - self.distance, self.rate, np.maximum(length - self.nearest, 0.0)])

    def modes(self, values: Mapping[str, float]) -> Integers:
        """The branches (function, time) that the law and its factors take."""
        return self.law.modes(self.times, self.states(values), self.law.numbers(values))

    def push(self, modes: Integers, values: Mapping[str, float], paths: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """The forces (time,), N, on given branches, and their derivatives (time, parameter) to `paths`."""
        force, slopes = self.law.evaluate(self.times, self.states(values), modes, self.law.numbers(values))
        known = {path: slopes[:, TO_MEMORY + i] for i, path in enumerate(self.law.paths)}
        # A longer free length deforms the joint more at every instant, and with it the largest deformation so far.
        known[self._free_length] = slopes[:, TO_D] + slopes[:, TO_D_MAX]
        return force, np.array([known.get(path, np.zeros(len(force))) for path in paths]).reshape(len(paths), -1).T

    @property
    def _free_length(self) -> str:
        return f"joint.{self.law.joint.name}.free_length"


def track_of(model: Model, joint: Joint, law: JointLaw, motion: xr.Dataset) -> Track:
    """A joint of a model along a motion, as `state_form` takes it (Mizzi & Jezequel 1992, eq 7-11)."""
    first, second = (_End.of(model, joint, number, motion) for number in (0, 1))
    apart, parting = second.place - first.place, second.speed - first.speed
    direction, turning = _direction(model, joint, first, apart)
    distance = (direction * apart).sum(axis=1)
    rate = -(direction * parting + turning * apart).sum(axis=1)
    length = float(distance[0]) if joint.free_length is None else joint.free_length.value
    # Against the flat face of the first body both forces act at the point of the second.
    first_arm = first.arm + apart if joint.normal is not None else first.arm
    rows = [[body.name for body in model.bodies].index(name) for name in joint.pushed]
    ends = (rows[0], -_wrench(direction, first_arm)), (rows[1], _wrench(direction, second.arm))
    return Track(
        law, motion.variables["time"].values.astype(float), distance, np.minimum.accumulate(distance), rate, length, ends
    )


def in_space(axes: Sequence[str], vector: Sequence[float]) -> np.ndarray:
    """A vector along the axes of a model as one along those of a motion: its one axis, or all three."""
    if len(axes) == 1:
        return np.array(vector, dtype=float)
    return np.array([vector[axes.index(axis)] if axis in axes else 0.0 for axis in XYZ])


def rotations(motion: xr.Dataset, body: str) -> Rotation:
    """The orientations of a body along a motion."""
    return Rotation.from_quat(motion["orientation"].sel(body=body).transpose("time", "quaternion").values, scalar_first=True)


@frozen(eq=False)
class _End:
    """The attachment of a joint on a body: its arm from the centre of mass, its place and speed, (time, axis)."""

    arm: np.ndarray
    place: np.ndarray
    speed: np.ndarray
    spin: np.ndarray
    frame: Rotation | None

    @classmethod
    def of(cls, model: Model, joint: Joint, number: int, motion: xr.Dataset) -> "_End":
        name = joint.bodies[number]
        point = joint.points[number] if joint.points else (0.0,) * len(model.axes)
        place = motion.variables["body"].values.tolist().index(name)
        position, velocity = (_by_body(motion, quantity)[:, place] for quantity in ("position", "velocity"))
        own = in_space(model.axes, point)
        if len(model.axes) == 1:
            arm = np.broadcast_to(own, position.shape)
            return cls(arm, position + arm, velocity, np.zeros_like(position), None)
        frame = rotations(motion, name)
        arm, spin = frame.apply(own), _by_body(motion, "angular_velocity")[:, place]
        return cls(arm, position + arm, velocity + np.cross(spin, arm), spin, frame)


def _by_body(motion: xr.Dataset, quantity: str) -> np.ndarray:
    """(time, body, axis). A bare variable: to set up a named array for each end of each joint takes longer than its use."""
    return np.asarray(motion.variables[quantity].transpose("time", "body", "axis").values)


def _direction(model: Model, joint: Joint, first: _End, apart: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where a joint pushes its second body, (time, axis), and how fast that turns as far as the distance feels it."""
    if first.frame is None:
        ends = [model.body(name).position[0] for name in joint.bodies]
        points = joint.points or ((0.0,), (0.0,))
        side = 1.0 if ends[1] + points[1][0] >= ends[0] + points[0][0] else -1.0
        return np.full_like(apart, side), np.zeros_like(apart)
    if joint.normal is not None:
        normal = first.frame.apply(in_space(model.axes, joint.normal))
        return normal, np.cross(first.spin, normal)
    return apart / np.linalg.norm(apart, axis=1, keepdims=True), np.zeros_like(apart)


def _wrench(direction: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """A unit force and, in several axes, its moment."""
    return direction if direction.shape[1] == 1 else np.hstack([direction, np.cross(arm, direction)])
