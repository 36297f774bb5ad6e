"""Where a body stands at t = 0: orientations as files write them, and points of a body in the laboratory frame."""

import math
from collections.abc import Sequence

import numpy as np

from crashkit.model.body import Body

ORIENTATION = {1: 0, 2: 1, 3: 4}
"""Numbers of an orientation by numbers of axes: none, the angle, the quaternion (w, x, y, z)."""
ROTATION = {1: 0, 2: 1, 3: 3}
"""Numbers of an angular velocity or a moment by numbers of axes."""
UNIT_TOLERANCE = 1e-6
"""How far from 1 the length of a vector may be that is meant to be a unit vector."""
ROUNDING = 1e-15
"""How far from 1 the length of a vector is that has been normalised."""


def is_unit(vector: Sequence[float]) -> bool:
    """Whether a vector is meant to be a unit vector."""
    return abs(math.hypot(*vector) - 1.0) <= UNIT_TOLERANCE


def normalised(vector: tuple[float, ...]) -> tuple[float, ...]:
    """A vector that is meant to be a unit vector with its length made 1; any other, and one that has it, as it is."""
    length = math.hypot(*vector)
    if not is_unit(vector) or abs(length - 1.0) <= ROUNDING:
        return vector
    return tuple(value / length for value in vector)


def laboratory_point(body: Body, point: Sequence[float]) -> np.ndarray:
    """A point of the body's frame (m, from the centre of mass) in the laboratory frame at t = 0."""
    return np.asarray(body.position) + turned(body.orientation, np.asarray(point, dtype=float))


def turned(orientation: Sequence[float], vector: np.ndarray) -> np.ndarray:
    """A vector of the body's frame in the laboratory frame.

    In the plane by the angle; in space by the unit quaternion (w, u), as v + 2 w (u x v) + 2 u x (u x v).
    """
    if len(orientation) == 1:
        cosine, sine = math.cos(orientation[0]), math.sin(orientation[0])
        return np.array([[cosine, -sine], [sine, cosine]]) @ vector
    if len(orientation) == 4:
        w, axis = orientation[0], np.asarray(orientation[1:])
        across = np.cross(axis, vector)
        return vector + 2.0 * w * across + 2.0 * np.cross(axis, across)
    return vector
