"""What passes from a base to a mass on a spring and a damper: a sensor on its mounting, a body that rocks."""

import numpy as np
from numba import njit

IMAGINARY = 1e-30
"""Step of complex differentiation: f' = Im f(x + i h) / h, without cancellation."""


WHOLE = np.ones(1)


def ringing(
    felt: np.ndarray, times: np.ndarray, frequency: np.ndarray, damping: np.ndarray, path: np.ndarray = WHOLE
) -> np.ndarray:
    """The acceleration of a mass that rings on its base, at rest before the first sample; or the displacement, of the base's.

    a = q + path 2 zeta q' / w with q'' + 2 zeta w q' + w^2 q = w^2 felt, w = 2 pi frequency: what passes from a base to the
    mass on it. Exact for accelerations that are linear between samples, however far apart.

    Arguments:
        felt: of the base, (time, channel, column).
        times: s.
        frequency: natural frequency in Hz, (channel,).
        damping: of critical, below 1, (channel,).
        path: 1 where it passes through spring and damper, as to a mass on its mount; 0 where what the spring bears is read, as
            of a sensing element; (channel,) or (1,).

    Nigam & Jennings, Bulletin of the Seismological Society of America 59 (1969) 909.
    """
    return _recursion(felt, _steps(times), frequency, damping, np.broadcast_to(path, frequency.shape))


def ringing_derivatives(
    felt: np.ndarray, times: np.ndarray, frequency: np.ndarray, damping: np.ndarray, path: np.ndarray = WHOLE
) -> tuple[np.ndarray, np.ndarray]:
    """The derivatives of `ringing` to frequency and damping, each in the shape of `felt`."""
    by_frequency = ringing(felt, times, frequency + 1j * IMAGINARY, damping + 0j, path)
    by_damping = ringing(felt, times, frequency + 0j, damping + 1j * IMAGINARY, path)
    return by_frequency.imag / IMAGINARY, by_damping.imag / IMAGINARY


def _steps(times: np.ndarray) -> np.ndarray:
    """The time before each sample, s; only one where the samples are uniform, or alone."""
    steps = np.diff(times) if len(times) > 1 else np.ones(1)
    uniform = np.ptp(steps) <= 1e-6 * steps[0]
    return steps.mean(keepdims=True) if uniform else np.concatenate([steps[:1], steps])


@njit(cache=True)
def _recursion(
    felt: np.ndarray, steps: np.ndarray, frequency: np.ndarray, damping: np.ndarray, path: np.ndarray
) -> np.ndarray:  # pragma: no cover
    """Complex where frequency and damping are."""
    result = np.empty(felt.shape, frequency.dtype)
    state = np.empty((felt.shape[2], 2), frequency.dtype)
    for channel in range(felt.shape[1]):
        state[:] = 0.0
        for time in range(len(felt)):
            if time < len(steps):
                e11, e12, e22, ramp, ramp_rate = _oscillator(2.0 * np.pi * frequency[channel] * steps[time], damping[channel])
            for column in range(felt.shape[2]):
                now, before = felt[time, channel, column], felt[time - 1, channel, column] if time else 0.0
                q, rate = state[column]
                state[column, 0] = e11 * q + e12 * rate - (e11 + ramp) * before + (1.0 + ramp) * now
                state[column, 1] = -e12 * q + e22 * rate + (e12 - ramp_rate) * before + ramp_rate * now
                result[time, channel, column] = state[column, 0] + path[channel] * 2.0 * damping[channel] * state[column, 1]
    return result


@njit(cache=True)
def _oscillator(angle: complex, damping: complex) -> tuple[complex, ...]:  # pragma: no cover
    """How a free oscillator (q, q' / w) moves on by `angle` = w h, and what a ramp of its input adds."""
    root = np.sqrt(1.0 - damping**2)
    decay = np.exp(-damping * angle)
    sine, cosine = decay * np.sin(root * angle) / root, decay * np.cos(root * angle)
    e11, e22 = cosine + damping * sine, cosine - damping * sine
    ramp = (2.0 * damping * (e11 - 1.0) - sine) / angle
    ramp_rate = (1.0 - 2.0 * damping * sine - e22) / angle
    return e11, sine, e22, ramp, ramp_rate
