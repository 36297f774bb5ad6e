"""From angular velocity to orientation, by Bortz's rotation vector."""

import numpy as np
from numba import njit


def bortz_rate(turn: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """How fast the rotation vector phi of a body changes, whose angular velocity is omega in its own axes.

    phi' = omega + phi x omega / 2 + (1 - phi sin phi / (2 (1 - cos phi))) / phi^2 phi x (phi x omega)

    Arguments:
        turn: phi, rad, (..., 3).
        omega: rad s-1, (..., 3).

    Equation (27) of Mizzi & Jezequel, JSV 159 (1992) 57; Bortz, IEEE Transactions on Aerospace and Electronic Systems 7
    (1971) 61.
    """
    angle = np.linalg.norm(turn, axis=-1, keepdims=True)
    half = 0.5 * np.where(angle > 1e-2, angle, 1.0)
    exact = (1.0 - half / np.tan(half)) / (4.0 * half**2)
    factor = np.where(angle > 1e-2, exact, 1.0 / 12.0 + angle**2 / 720.0)
    across = np.cross(turn, omega)
    return omega + 0.5 * across + factor * np.cross(turn, across)


def orientations(times: np.ndarray, omega: np.ndarray, alpha: np.ndarray, start: np.ndarray) -> np.ndarray:
    """The orientation of a body at every sample.

    Bortz's equation over each interval, from phi = 0, by the classical Runge-Kutta scheme (fourth order), so that no angle is
    too large; omega within an interval is the cubic through its ends.

    Arguments:
        times: s, (time,).
        omega, alpha: angular velocity and acceleration in the body's axes, rad s-1 and rad s-2, (time, 3).
        start: unit quaternion (w, x, y, z) at the first sample.

    Returns:
        Unit quaternions, (time, 4).
    """
    step = np.diff(times)[:, None]
    first, last = omega[:-1], omega[1:]
    middle = 0.5 * (first + last) + step / 8.0 * (alpha[:-1] - alpha[1:])
    second = bortz_rate(0.5 * step * first, middle)
    third = bortz_rate(0.5 * step * second, middle)
    fourth = bortz_rate(step * third, last)
    return _composed(step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth), start)


@njit(cache=True)
def _composed(turns: np.ndarray, start: np.ndarray) -> np.ndarray:  # pragma: no cover
    """Rotation vectors one after the other, each in the axes that the one before left."""
    result = np.empty((len(turns) + 1, 4))
    result[0] = start
    for index in range(len(turns)):
        w, x, y, z = result[index]
        angle = np.sqrt(np.sum(turns[index] ** 2))
        a, b, c = turns[index] * (np.sin(0.5 * angle) / angle if angle > 1e-12 else 0.5)
        s = np.cos(0.5 * angle)
        result[index + 1, 0] = w * s - x * a - y * b - z * c
        result[index + 1, 1] = w * a + x * s + y * c - z * b
        result[index + 1, 2] = w * b - x * c + y * s + z * a
        result[index + 1, 3] = w * c + x * b - y * a + z * s
        result[index + 1] /= np.sqrt(np.sum(result[index + 1] ** 2))
    return result
