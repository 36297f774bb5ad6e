"""Joints along a given motion: how it deforms them, where they push, and how hard (Mizzi & Jezequel 1992, eq 7-11)."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.spatial.transform import Rotation

from crashkit.mechanics.engine import Engine, compile_engine
from crashkit.mechanics.given import side_of
from crashkit.mechanics.joint_law import JointLaw
from crashkit.mechanics.kernel.arrays import TO_D, TO_D_MAX, TO_MEMORY, Integers
from crashkit.mechanics.layout import functions_of
from crashkit.mechanics.motion import XYZ
from crashkit.model import Joint, Model
from crashkit.protocols import Laws


@frozen(eq=False)
class Stretch:
    """How a motion deforms a joint.

    Arguments:
        free_length: path of its free length.
        direction: (time, axis), in which it pushes its second body.
        distance, nearest: (time,) m, of its ends, and the least so far.
        rate: (time,) m s-1, of its deformation.
        length: (time,) m, its free length where the values do not give it.
    """

    free_length: str
    direction: np.ndarray
    distance: np.ndarray
    nearest: np.ndarray
    rate: np.ndarray
    length: np.ndarray

    def states(self, values: Mapping[str, float]) -> np.ndarray:
        """(time, 3), deformation, its rate, and the largest deformation so far."""
        length = values.get(self.free_length, self.length)
        return np.column_stack([length - self.distance, self.rate, np.maximum(length - self.nearest, 0.0)])


@frozen(eq=False)
class Track:
    """The force of a joint along a motion, and its derivatives.

    Arguments:
        law: what gives them.
        times: (time,) s.
        own: how the motion deforms it.
        driver: how it deforms the joint that drives it, if one does.
        ends: of both bodies, the row, and (time, axis) what a force of 1 N puts on it: a force and, in several axes, a moment.
    """

    law: JointLaw
    times: np.ndarray
    own: Stretch
    driver: Stretch | None
    ends: tuple[tuple[int, np.ndarray], tuple[int, np.ndarray]]

    def states(self, values: Mapping[str, float]) -> np.ndarray:
        """(time, 3), deformation, its rate, and the largest deformation so far."""
        return self.own.states(values)

    def force(self, values: Mapping[str, float]) -> np.ndarray:
        """What it pushes with, (time,), N."""
        return self.law.forces(self.times, self.states(values), self.law.numbers(values), self._drive(values))

    def modes(self, values: Mapping[str, float]) -> Integers:
        """The branches (function, time) that the law and its factors take."""
        return self.law.modes(self.times, self.states(values), self.law.numbers(values), self._drive(values))

    @property
    def paths(self) -> tuple[str, ...]:
        """Of the parameters that its force depends on."""
        lengths = [stretch.free_length for stretch in (self.own, self.driver) if stretch is not None]
        return (*self.law.paths, *lengths)

    def push(self, modes: Integers, values: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
        """The forces (time,), N, on given branches, and their derivatives (time, parameter) to its `paths`."""
        states, drive = self.states(values), self._drive(values)
        force, slopes, driven = self.law.evaluate(self.times, states, modes, self.law.numbers(values), drive)
        # A longer free length deforms the joint more at every instant, and with it the largest deformation so far.
        to_lengths = [slopes[:, TO_D] + slopes[:, TO_D_MAX], *([] if self.driver is None else [driven[:, TO_D]])]
        return force, np.column_stack([slopes[:, TO_MEMORY:], *to_lengths])

    def _drive(self, values: Mapping[str, float]) -> np.ndarray | None:
        return None if self.driver is None else self.driver.states(values)


def shared(names: Sequence[str], paths: Sequence[str]) -> tuple[list[int], list[int]]:
    """Which of some names are among the paths, and where."""
    own = [index for index, name in enumerate(names) if name in paths]
    return own, [paths.index(names[index]) for index in own]


def tracks_of(model: Model, laws: Laws, motion: xr.Dataset, engine: Engine | None = None) -> list[Track]:
    """The joints of a model along a motion, as `state_form` takes them; `engine` None: one of their own."""
    engine = engine or compile_engine(functions_of(model, laws), len(model.axes))
    return [track_of(model, JointLaw(joint, laws, engine), motion) for joint in model.joints]


def track_of(model: Model, law: JointLaw, motion: xr.Dataset) -> Track:
    """The joint of a law along a motion."""
    joint = law.joint
    first, second = (_End.of(model, joint, number, motion) for number in (0, 1))
    own = stretch_of(model, joint, motion)
    # Against the flat face of the first body both forces act at the point of the second.
    first_arm = first.arm if joint.normal is None else first.arm + second.place - first.place
    rows = [[body.name for body in model.bodies].index(name) for name in joint.pushed]
    ends = (rows[0], -_wrench(own.direction, first_arm)), (rows[1], _wrench(own.direction, second.arm))
    driver = stretch_of(model, model.joint(joint.driver), motion) if joint.driver else None
    return Track(law, motion.variables["time"].values.astype(float), own, driver, ends)


def load_on(rest: np.ndarray, tracks: Iterable[Track], forces: Iterable[np.ndarray]) -> np.ndarray:
    """What acts on each body, (time, body, axis), N, and in several axes as many moments, N m.

    Arguments:
        rest: likewise, what acts besides these joints.
        tracks, forces: the joints, and what each pushes with, (time,), N.
    """
    load = rest.copy()
    for track, force in zip(tracks, forces, strict=True):
        for row, along in track.ends:
            load[:, row] += force[:, None] * along
    return load


def stretch_of(model: Model, joint: Joint, motion: xr.Dataset) -> Stretch:
    """How a motion deforms a joint between bodies of the model; where time goes back, another motion begins."""
    first, second = (_End.of(model, joint, number, motion) for number in (0, 1))
    apart, parting = second.place - first.place, second.speed - first.speed
    direction, turning = _direction(model, joint, first, apart)
    distance = (direction * apart).sum(axis=1)
    rate = -(direction * parting + turning * apart).sum(axis=1)
    motions = np.split(distance, np.flatnonzero(np.diff(motion.variables["time"].values) < 0.0) + 1)
    nearest = np.concatenate([np.minimum.accumulate(one) for one in motions])
    lengths = [np.full_like(one, one[0] if joint.free_length is None else joint.free_length.value) for one in motions]
    return Stretch(f"joint.{joint.name}.free_length", direction, distance, nearest, rate, np.concatenate(lengths))


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
        return np.full_like(apart, side_of(model, joint)), np.zeros_like(apart)
    if joint.normal is not None:
        normal = first.frame.apply(in_space(model.axes, joint.normal))
        return normal, np.cross(first.spin, normal)
    return apart / np.linalg.norm(apart, axis=1, keepdims=True), np.zeros_like(apart)


def _wrench(direction: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """A unit force and, in several axes, its moment."""
    return direction if direction.shape[1] == 1 else np.hstack([direction, np.cross(arm, direction)])
