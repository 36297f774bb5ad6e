"""The acceleration of points fixed on bodies that turn, and its derivatives by the chain rule."""

import numpy as np
import xarray as xr
from numba import njit

from crashkit.errors import CrashkitError
from crashkit_accelerometers.rotations import matrices
from crashkit_accelerometers.sampling import Felt

VECTORS = ("acceleration", "angular_acceleration", "angular_velocity")
Vector = tuple[float, float, float]


def felt_by_points(motion: xr.Dataset, bodies: np.ndarray, points: np.ndarray, body_frame: bool) -> Felt:
    """What perfect accelerometers feel: a_p = a + alpha x r + omega x (omega x r), r = R p, along axes that may turn.

    Arguments:
        motion: with `orientation` and VECTORS along x, y and z; with the sensitivities of all of them, that of the orientation
            being `rotation_sensitivity`, if it has any.
        bodies: of each sensor, its index in the motion.
        points: m, body frame, (sensor, 3).
        body_frame: whether the sensors' axes turn with their bodies.

    Equations (16) and (17) of Mizzi & Jezequel, JSV 159 (1992) 57.
    """
    rotation = matrices(_values(motion, "orientation"))
    a, alpha, omega = (_values(motion, name) for name in VECTORS)
    values, by_point, by_motion = _felt(rotation, a, alpha, omega, bodies, points, body_frame)
    sensitivity = None
    if "acceleration_sensitivity" in motion.variables:
        changes = [_values(motion, f"{name}_sensitivity") for name in (*VECTORS, "rotation")]
        sensitivity = _chained(by_motion, bodies, *changes)
    axes = tuple(motion.variables["axis"].values.tolist())
    return Felt(motion.variables["time"].values, values, sensitivity, by_point, np.arange(len(bodies)), axes)


def _values(motion: xr.Dataset, name: str) -> np.ndarray:
    if name not in motion.variables:
        raise CrashkitError(f"accelerometer: expected a motion with {name}, found none")
    return np.ascontiguousarray(motion.variables[name].values)


@njit(cache=True)
def _felt(
    rotation: np.ndarray,
    a: np.ndarray,
    alpha: np.ndarray,
    omega: np.ndarray,
    bodies: np.ndarray,
    points: np.ndarray,
    own: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # pragma: no cover
    """What is felt (node, sensor, 3), and how it changes with the point (..., 3) and with VECTORS and a small turn (..., 12).

    Along a direction e a point feels e a_p. With g = e x alpha + omega x (omega x e) this changes with a by e, with alpha by
    r x e, with omega by (omega x r) x e + r x (e x omega), with p by R' g, and with a small turn by r x g, and by e x a_p more
    where e turns too.
    """
    count = len(rotation), len(bodies), 3
    values, by_point, by_motion = np.empty(count), np.empty((*count, 3)), np.empty((*count, 12))
    laboratory = np.eye(3)
    for time in range(count[0]):
        for sensor in range(count[1]):
            turn, spin = rotation[time, bodies[sensor]], _vector(omega[time, bodies[sensor]])
            push, twist = _vector(a[time, bodies[sensor]]), _vector(alpha[time, bodies[sensor]])
            p = points[sensor]
            arm = _sum(_scaled(p[0], turn[:, 0]), _sum(_scaled(p[1], turn[:, 1]), _scaled(p[2], turn[:, 2])))
            swing = _cross(spin, arm)
            total = _sum(push, _sum(_cross(twist, arm), _cross(spin, swing)))
            for row in range(3):
                e = _vector(turn[:, row]) if own else _vector(laboratory[row])
                g = _sum(_cross(e, twist), _cross(spin, _cross(spin, e)))
                values[time, sensor, row] = e[0] * total[0] + e[1] * total[1] + e[2] * total[2]
                by_omega = _sum(_cross(swing, e), _cross(arm, _cross(e, spin)))
                by_turn = _sum(_cross(arm, g), _cross(e, total)) if own else _cross(arm, g)
                for axis in range(3):
                    by_point[time, sensor, row, axis] = turn[0, axis] * g[0] + turn[1, axis] * g[1] + turn[2, axis] * g[2]
                    changes = by_motion[time, sensor, row]
                    changes[axis], changes[3 + axis] = e[axis], _cross(arm, e)[axis]
                    changes[6 + axis], changes[9 + axis] = by_omega[axis], by_turn[axis]
    return values, by_point, by_motion


@njit(cache=True)
def _vector(v: np.ndarray) -> Vector:  # pragma: no cover
    """As a tuple, which needs no memory."""
    return v[0], v[1], v[2]


@njit(cache=True)
def _scaled(factor: float, v: np.ndarray) -> Vector:  # pragma: no cover
    return factor * v[0], factor * v[1], factor * v[2]


@njit(cache=True)
def _sum(v: Vector, w: Vector) -> Vector:  # pragma: no cover
    return v[0] + w[0], v[1] + w[1], v[2] + w[2]


@njit(cache=True)
def _cross(v: Vector, w: Vector) -> Vector:  # pragma: no cover
    return v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]


@njit(cache=True)
def _chained(
    by_motion: np.ndarray, bodies: np.ndarray, a: np.ndarray, alpha: np.ndarray, omega: np.ndarray, turn: np.ndarray
) -> np.ndarray:  # pragma: no cover
    """The sum over the 12 quantities of each sensor's body."""
    result = np.zeros((*by_motion.shape[:2], 3, a.shape[3]))
    for time in range(len(result)):
        for sensor in range(len(bodies)):
            for kind, changes in enumerate((a, alpha, omega, turn)):
                for axis in range(3):
                    target = result[time, sensor, axis]
                    for inner in range(3):
                        share = by_motion[time, sensor, axis, 3 * kind + inner]
                        source = changes[time, bodies[sensor], inner]
                        for column in range(a.shape[3]):
                            target[column] += share * source[column]
    return result
