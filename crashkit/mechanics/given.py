"""What is given rather than simulated, as a table that is affine between its knots: gravity, forces, imposed motions."""

import itertools
from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from attrs import frozen
from scipy.interpolate import CubicSpline, PPoly
from scipy.spatial.transform import Rotation, RotationSpline

from crashkit.mechanics.kernel.arrays import Floats
from crashkit.model import Body, GivenForce, GivenMotion, Joint, Model

PARTS = 20
"""Into which each interval of an imposed rotation in space is divided, because its angular acceleration is not affine
there."""


@frozen
class Series:
    """A polynomial in time for some of the velocities; 0 before its first and after its last knot.

    Arguments:
        start: number of the first velocity, in the order of the kernel.
        kind: 0 for a force, 1 for an acceleration.
        curve: affine between its knots.
    """

    start: int
    kind: int
    curve: PPoly


def given_table(model: Model, dof: int) -> Floats:
    """The table of the kernel: (knot, 1 + 4 n), see `Work.given`."""
    n = dof * len(model.bodies)
    series = list(itertools.chain.from_iterable(_series(body, dof * i, dof) for i, body in enumerate(model.bodies)))
    times = np.unique(np.concatenate([[0.0], *(entry.curve.x for entry in series)]))
    knots = times[times >= 0.0]
    table = np.zeros((knots.size, 2, 2, n))
    for i, body in enumerate(model.bodies):
        if model.gravity and body.is_free:
            table[:, 1, 0, dof * i : dof * i + len(model.axes)] = model.gravity
    for entry in series:
        value, slope = (np.nan_to_num(entry.curve(knots, order, extrapolate=False)) for order in (0, 1))
        beyond = knots >= entry.curve.x[-1]
        value[beyond], slope[beyond] = 0.0, 0.0
        columns = slice(entry.start, entry.start + value.shape[1])
        table[:, entry.kind, 0, columns] += value
        table[:, entry.kind, 1, columns] += slope
    return np.column_stack([knots, table.reshape(knots.size, 4 * n)])


def imposed_start(motion: GivenMotion, dof: int) -> tuple[Floats, Floats, Floats | None]:
    """Positions and velocities of an imposed motion at t = 0, in the order of the kernel; in space also the quaternion."""
    curve, turning = _position(motion), _rotation(motion) if dof == 6 else None
    instant = float(np.clip(0.0, motion.time[0], motion.time[-1]))
    velocity = curve(instant, 1)
    position = curve(instant) - instant * velocity
    if dof < 6:
        return position, velocity, None
    rate = np.zeros(3)
    quaternion = None
    if turning is not None:
        rate = turning(instant).apply(turning(instant, 1))
        orientation = Rotation.from_rotvec(-instant * rate) * turning(instant)
        quaternion = orientation.as_quat(scalar_first=True)
    return np.append(position, np.zeros(3)), np.append(velocity, rate), quaternion


def side_of(model: Model, joint: Joint) -> float:
    """On which side of a joint's first end its second one lies at t = 0, on a line: its direction for ever."""
    bodies = [model.body(name) for name in joint.bodies]
    places = [body.position if body.motion is None else imposed_start(body.motion, 1)[0] for body in bodies]
    points = joint.points or ((0.0,), (0.0,))
    first, second = (float(place[0]) + point[0] for place, point in zip(places, points, strict=True))
    return 1.0 if second >= first else -1.0


def _series(body: Body, start: int, dof: int) -> Iterator[Series]:
    if body.force is not None:
        yield Series(start, 0, _force(body.force, dof))
    if body.motion is not None:
        yield Series(start, 1, _position(body.motion).derivative(2))
        turning = _rotation(body.motion) if dof == 6 else None
        if turning is not None:
            yield Series(start + 3, 1, _angular_acceleration(turning))


def _force(force: GivenForce, dof: int) -> PPoly:
    rows = np.array(force.force)
    if force.moment:
        rows = np.column_stack([rows, np.array(force.moment)])
    return _affine(np.array(force.time), rows)


def _affine(times: Floats, rows: Floats) -> PPoly:
    return PPoly([np.diff(rows, axis=0) / np.diff(times)[:, None], rows[:-1]], times, extrapolate=False)


@lru_cache(maxsize=64)
def _position(motion: GivenMotion) -> PPoly:
    """Remembered: many models have their bodies moved alike."""
    rows = np.array(motion.position)
    if motion.orientation and len(motion.orientation[0]) == 1:
        rows = np.column_stack([rows, np.unwrap(np.array(motion.orientation), axis=0)])
    return CubicSpline(motion.time, rows)


def _rotation(motion: GivenMotion) -> RotationSpline | None:
    if not motion.orientation:
        return None
    return RotationSpline(motion.time, Rotation.from_quat(np.array(motion.orientation), scalar_first=True))


def _angular_acceleration(turning: RotationSpline) -> PPoly:
    """In the laboratory frame; the spline's are in the body's."""
    ends = turning.times
    times = np.concatenate([np.linspace(a, b, PARTS, endpoint=False) for a, b in itertools.pairwise(ends)] + [ends[-1:]])
    return _affine(times, turning(times).apply(turning(times, 2)))
