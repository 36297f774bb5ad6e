"""Points fixed on bodies that turn: where they are, how fast, and the derivatives of that by the chain rule."""

import numpy as np
from numba import njit


@njit(cache=True)
def turning(
    rows: np.ndarray,
    bodies: np.ndarray,
    points: np.ndarray,
    axes: np.ndarray,
    position: np.ndarray,
    velocity: np.ndarray,
    orientation: np.ndarray,
    spin: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # pragma: no cover
    """x + r and x' + omega x r of each point along some axes, (row, point, axis), and r = R p, (row, point, 3).

    Arguments:
        rows: of the motion.
        bodies: of each point, its index in the motion.
        points: p, m, in the frames of their bodies, (point, 3).
        axes: that are wanted, of x, y and z.
        position, velocity, spin: x, x' and omega, (time, body, 3).
        orientation: unit quaternions (w, x, y, z), (time, body, 4).
    """
    arms = np.empty((len(rows), len(bodies), 3))
    places, speeds = np.empty((2, len(rows), len(bodies), len(axes)))
    for row, time in enumerate(rows):
        for point, body in enumerate(bodies):
            arm, omega = arms[row, point], spin[time, body]
            w, q = orientation[time, body, 0], orientation[time, body, 1:]
            along = q[0] * points[point, 0] + q[1] * points[point, 1] + q[2] * points[point, 2]
            squares = q[0] * q[0] + q[1] * q[1] + q[2] * q[2]
            for axis in range(3):
                swung = _cross(q, points[point], axis)
                arm[axis] = (w * w - squares) * points[point, axis] + 2.0 * (along * q[axis] + w * swung)
            for column, axis in enumerate(axes):
                places[row, point, column] = position[time, body, axis] + arm[axis]
                speeds[row, point, column] = velocity[time, body, axis] + _cross(omega, arm, axis)
    return places, speeds, arms


@njit(cache=True)
def turning_slopes(
    rows: np.ndarray,
    bodies: np.ndarray,
    arms: np.ndarray,
    axes: np.ndarray,
    spin: np.ndarray,
    position_slope: np.ndarray,
    velocity_slope: np.ndarray,
    turn: np.ndarray,
    spin_slope: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover
    """dx + theta x r and dx' + d omega x r + omega x (theta x r), (row, point, axis, parameter).

    Arguments:
        arms: r, as `turning` returns it; `rows`, `bodies`, `axes` and `spin` as there.
        position_slope, velocity_slope, spin_slope: dx, dx' and d omega, (time, body, 3, parameter).
        turn: theta, a small turn of each body, likewise.
    """
    shape = (len(rows), len(bodies), len(axes), turn.shape[3])
    place_slopes, speed_slopes = np.empty(shape), np.empty(shape)
    swung = np.empty((3, turn.shape[3]))
    for row, time in enumerate(rows):
        for point, body in enumerate(bodies):
            arm, omega = arms[row, point], spin[time, body]
            theta, change = turn[time, body], spin_slope[time, body]
            for axis in range(3):
                for parameter in range(shape[3]):
                    swung[axis, parameter] = _cross(theta[:, parameter], arm, axis)
            for column, axis in enumerate(axes):
                place, speed = place_slopes[row, point, column], speed_slopes[row, point, column]
                for parameter in range(shape[3]):
                    faster = _cross(change[:, parameter], arm, axis) + _cross(omega, swung[:, parameter], axis)
                    place[parameter] = position_slope[time, body, axis, parameter] + swung[axis, parameter]
                    speed[parameter] = velocity_slope[time, body, axis, parameter] + faster
    return place_slopes, speed_slopes


@njit(cache=True)
def _cross(v: np.ndarray, w: np.ndarray, axis: int) -> float:  # pragma: no cover
    """One component of v x w."""
    after, last = (axis + 1) % 3, (axis + 2) % 3
    return v[after] * w[last] - v[last] * w[after]
