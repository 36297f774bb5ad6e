"""The angular velocity of a rigid body from all that its accelerometers record."""

import numpy as np
from numba import njit
from scipy.interpolate import CubicSpline

from crashkit.errors import CrashkitError
from crashkit_accelerometers.rotations import cross_matrix
from crashkit_accelerometers.sensor_array import SensorArray
from crashkit_accelerometers.smoother import smoothed

MOST_STEPS = 20
CONVERGED = 1e-6
"""rad s-1; a step so small leaves its square."""


class AngularMotion:
    """Angular velocity and acceleration in the body's axes, as the most likely path given every reading.

    Each sample tells the angular acceleration, alpha = M^-1 (sum d x f / std^2 - omega x M omega), which integrates to omega,
    and by its redundant combinations the centripetal terms, which see omega itself: a path is sought that fits both.

    Arguments:
        array: which must see the rotation.
        times: s.
        readings: along x, y and z of the body, m s-2, (time, sensor, 3).
        correlation: samples that make one independent one.
        start: omega at the first sample, rad s-1, (3,).

    Equations (18) to (20) of Mizzi & Jezequel, JSV 159 (1992) 57.
    """

    def __init__(
        self, array: SensorArray, times: np.ndarray, readings: np.ndarray, correlation: float, start: np.ndarray
    ) -> None:
        self.array = array
        self._steps = np.diff(times)
        self._correlation = correlation
        self._moment, self._inverse = array.second_moment, array.angular_covariance
        self._redundant = array.redundant
        weighted = readings[..., list(array.recorded)] / array.std[:, None]
        self._shown = weighted.reshape(len(times), -1) @ self._redundant.T
        torque = np.sum(np.cross(array.arms, readings / array.std[:, None] ** 2), axis=1)
        middle = CubicSpline(times, torque)(times[:-1] + 0.5 * self._steps)
        self._torques = np.stack([torque[:-1], middle, torque[1:]], axis=1)
        self.omega = _path(start, self._torques, self._steps, self._moment, self._inverse)
        self._doubt = 1.0
        if len(array.rotations):
            self._smooth()
        self.alpha = (torque - np.cross(self.omega, self.omega @ self._moment)) @ self._inverse

    @property
    def disagreement(self) -> float:
        """The size of what redundant readings say against a rigid body, over their noise; 0 where none is redundant."""
        residual = self._residual()
        return float(np.sqrt(np.mean(residual**2))) if residual.size else 0.0

    def _smooth(self) -> None:
        """From the integrated path to the most likely one; where no path suits the redundant readings, they count less."""
        integrated = self.omega
        for doubt in (1.0, self.disagreement):
            self.omega, self._doubt = integrated, doubt
            if self._converges():
                return
        raise CrashkitError(
            f"accelerometer: {self.array.body}: expected readings of a rigid body, found none that any rotation comes near to"
        )

    def _converges(self) -> bool:
        """Whether Gauss-Newton steps come to an end."""
        for _ in range(MOST_STEPS):
            leaps = _leaps(self.omega, self._torques, self._steps, self._moment, self._inverse)
            seen, residual = self.observed()
            try:
                change, _ = smoothed(self.transition(), self.noise(), leaps - self.omega[1:], seen, residual)
            except np.linalg.LinAlgError:
                return False
            self.omega = self.omega + change
            if np.abs(change).max() < CONVERGED:
                return True
        return False

    def rate(self) -> np.ndarray:
        """d alpha / d omega, (time, 3, 3)."""
        spin, momentum = cross_matrix(self.omega), cross_matrix(self.omega @ self._moment)
        return self._inverse @ (momentum - spin @ self._moment)

    def transition(self) -> np.ndarray:
        """How an error of omega goes on from sample to sample, (time - 1, 3, 3)."""
        rate = self.rate()
        turn = 0.5 * self._steps[:, None, None] * (rate[1:] + rate[:-1])
        return np.eye(3) + turn + 0.5 * turn @ turn

    def noise(self) -> np.ndarray:
        """What every step adds to the covariance of omega, (time - 1, 3, 3)."""
        return self._correlation * self._steps[:, None, None] ** 2 * self._inverse

    def observed(self) -> tuple[np.ndarray, np.ndarray]:
        """How the redundant readings, of variance 1, see an error of omega, and what they show of it.

        Returns:
            (time, reading, 3) and (time, reading); one reading that sees nothing where none is redundant.
        """
        if not len(self._redundant):
            return np.zeros((len(self.omega), 1, 3)), np.zeros((len(self.omega), 1))
        std = self._doubt * np.sqrt(self._correlation)
        change = centripetal_rate(self.omega, self.array.arms)[:, :, list(self.array.recorded)] / self.array.std[:, None, None]
        seen = self._redundant @ change.reshape(len(change), -1, 3)
        return np.ascontiguousarray(seen) / std, self._residual() / std

    def _residual(self) -> np.ndarray:
        """The redundant readings less the centripetal terms, over their noise, (time, reading)."""
        expected = centripetal(self.omega, self.array.arms)[..., list(self.array.recorded)] / self.array.std[:, None]
        return self._shown - expected.reshape(len(expected), -1) @ self._redundant.T


def centripetal(omega: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """omega x (omega x d), (time, 3) and (sensor, 3) to (time, sensor, 3)."""
    along = omega @ arms.T
    return along[..., None] * omega[:, None] - np.sum(omega**2, axis=1)[:, None, None] * arms


def centripetal_rate(omega: np.ndarray, arms: np.ndarray) -> np.ndarray:
    """Its derivative to omega, (time, sensor, 3, 3)."""
    along = omega @ arms.T
    outer = omega[:, None, :, None] * arms[:, None, :]
    return along[..., None, None] * np.eye(3) + outer - 2.0 * np.swapaxes(outer, -1, -2)


@njit(cache=True)
def _leap(
    omega: np.ndarray, torques: np.ndarray, step: float, moment: np.ndarray, inverse: np.ndarray
) -> np.ndarray:  # pragma: no cover
    """One step of the classical Runge-Kutta scheme."""
    rate = total = np.zeros(3)
    for reach, torque, weight in ((0.0, 0, 1.0), (0.5, 1, 2.0), (0.5, 1, 2.0), (1.0, 2, 1.0)):
        at = omega + reach * step * rate
        rate = inverse @ (torques[torque] - np.cross(at, moment @ at))
        total = total + weight * rate
    return omega + step / 6.0 * total


@njit(cache=True)
def _path(
    start: np.ndarray, torques: np.ndarray, steps: np.ndarray, moment: np.ndarray, inverse: np.ndarray
) -> np.ndarray:  # pragma: no cover
    omega = np.empty((len(steps) + 1, 3))
    omega[0] = start
    for index in range(len(steps)):
        omega[index + 1] = _leap(omega[index], torques[index], steps[index], moment, inverse)
    return omega


@njit(cache=True)
def _leaps(
    omega: np.ndarray, torques: np.ndarray, steps: np.ndarray, moment: np.ndarray, inverse: np.ndarray
) -> np.ndarray:  # pragma: no cover
    """Where one step from each sample ends."""
    ends = np.empty((len(steps), 3))
    for index in range(len(steps)):
        ends[index] = _leap(omega[index], torques[index], steps[index], moment, inverse)
    return ends
