"""How the noise of accelerometers grows into errors of orientation, velocity and position."""

import numpy as np
from attrs import frozen

from crashkit_accelerometers.angular_motion import AngularMotion, centripetal_rate
from crashkit_accelerometers.rotations import cross_matrix
from crashkit_accelerometers.smoother import smoothed

OMEGA, TURN, VELOCITY, POSITION = (slice(3 * index, 3 * index + 3) for index in range(4))
"""Of the state: errors of omega (body axes), of the orientation (a small rotation vector), and of the barycentre's motion."""


@frozen(eq=False)
class Path:
    """A reconstructed motion in the laboratory frame; (time, 3), but for `rotation` (time, 3, 3).

    Attributes:
        rotation: from the body's axes.
        push: acceleration of the barycentre of the sensors.
        acceleration: of the centre of mass.
        omega, alpha: angular velocity and acceleration.
    """

    rotation: np.ndarray
    push: np.ndarray
    acceleration: np.ndarray
    omega: np.ndarray
    alpha: np.ndarray


def standard_deviations(angular: AngularMotion, path: Path, steps: np.ndarray, correlation: float) -> dict[str, np.ndarray]:
    """The standard deviation of every quantity of a reconstructed motion, (time, 3), by its name.

    Arguments:
        angular: what the readings tell of the angular velocity.
        path: the motion.
        steps: s, between samples.
        correlation: samples that make one independent one.
    """
    covariance = _covariance(angular, path, steps, correlation)
    fresh = _noise_of_a_sample(angular, path)
    deviations = {}
    for name, change in _changes(angular, path).items():
        variance = np.einsum("tij,tjk,tik->ti", change, covariance, change)
        if name in fresh:
            variance = variance + np.einsum("tij,jk,tik->ti", path.rotation, fresh[name], path.rotation)
        deviations[name] = np.sqrt(np.maximum(variance, 0.0))
    return deviations


def _covariance(angular: AngularMotion, path: Path, steps: np.ndarray, correlation: float) -> np.ndarray:
    """Of the state, (time, 12, 12): noise enters omega and the velocity in mid-step, and the redundant readings see omega."""
    count = len(path.rotation)
    rate = np.zeros((count, 12, 12))
    rate[:, OMEGA, OMEGA] = angular.rate()
    rate[:, TURN, OMEGA] = path.rotation
    rate[:, VELOCITY, TURN] = -cross_matrix(path.push)
    rate[:, POSITION, VELOCITY] = np.eye(3)
    move = 0.5 * steps[:, None, None] * (rate[1:] + rate[:-1])
    noise = np.zeros((count - 1, 12, 12))
    noise[:, OMEGA, OMEGA] = angular.noise()
    turned = path.rotation[1:] @ angular.array.push_covariance @ np.swapaxes(path.rotation[1:], 1, 2)
    noise[:, VELOCITY, VELOCITY] = correlation * steps[:, None, None] ** 2 * turned
    entered = np.eye(12) + 0.5 * move
    noise = entered @ noise @ np.swapaxes(entered, 1, 2)
    seen, residual = angular.observed()
    wide = np.zeros((count, seen.shape[1], 12))
    wide[:, :, OMEGA] = seen
    _, covariance = smoothed(
        np.eye(12) + move + 0.5 * move @ move, noise, np.zeros((count - 1, 12)), wide, np.zeros_like(residual)
    )
    return covariance


def _changes(angular: AngularMotion, path: Path) -> dict[str, np.ndarray]:
    """How the state changes every quantity, (time, 3, 12)."""
    offset = -angular.array.centre
    spin, arm = cross_matrix(path.omega), cross_matrix(np.einsum("tij,j->ti", path.rotation, offset))
    none, one = np.zeros_like(spin), np.broadcast_to(np.eye(3), spin.shape)
    rate = angular.rate()
    omega = np.concatenate([path.rotation, -spin, none, none], axis=2)
    inner = centripetal_rate(angular.omega, offset[None])[:, 0] - cross_matrix(offset) @ rate
    swing = np.concatenate([none, spin @ arm, -one, none], axis=2)
    return {
        "orientation": np.concatenate([none, one, none, none], axis=2),
        "angular_velocity": omega,
        "angular_acceleration": np.concatenate([path.rotation @ rate, -cross_matrix(path.alpha), none, none], axis=2),
        "acceleration": np.concatenate([path.rotation @ inner, -cross_matrix(path.acceleration), none, none], axis=2),
        "velocity": -arm @ omega - swing,
        "position": np.concatenate([none, -arm, none, one], axis=2),
    }


def _noise_of_a_sample(angular: AngularMotion, path: Path) -> dict[str, np.ndarray]:
    """What the noise of the sample itself adds to the covariance of accelerations, in the body's axes, (3, 3)."""
    arm, turning = cross_matrix(-angular.array.centre), angular.array.angular_covariance
    return {"angular_acceleration": turning, "acceleration": angular.array.push_covariance + arm @ turning @ arm.T}
