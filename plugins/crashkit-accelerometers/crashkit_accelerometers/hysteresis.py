"""Hysteresis: a reading that lags behind, on one branch while the acceleration rises and on another while it falls."""

import math

import numpy as np
from attrs import frozen
from numba import njit


@frozen(eq=False)
class Branch:
    """Where a channel is between its falling branch (-1) and its rising branch (1), and what that depends on.

    dz = (1 - z sign(ds)) ds / travel: Dahl's model of friction, which no rate enters; z = 0 at rest, before the first sample.

    Attributes:
        position: z, (time, channel).
        keep, slope: dz_k = keep_k dz_(k-1) + slope_k d(s_k - s_(k-1)).

    Dahl, AIAA Journal 14 (1976) 1675.
    """

    position: np.ndarray
    keep: np.ndarray
    slope: np.ndarray

    def along(self, columns: np.ndarray) -> np.ndarray:
        """The derivatives of z, given those of the channel, (time, channel, column)."""
        return _recursion(self.keep, self.slope[..., None] * np.diff(columns, axis=0, prepend=0.0))

    def by_travel(self, signal: np.ndarray, travel: np.ndarray) -> np.ndarray:
        """The derivative of z to the travel, (time, channel)."""
        relative = -self.slope * np.diff(signal, axis=0, prepend=0.0) / travel
        return _recursion(self.keep, relative[..., None])[..., 0]


def branch(signal: np.ndarray, travel: np.ndarray) -> Branch:
    """The branch that a channel is on.

    Arguments:
        signal: (time, channel).
        travel: how far the signal moves to come from one branch near the other, (channel,).
    """
    return Branch(*_branch(signal, travel))


@njit(cache=True)
def _branch(signal: np.ndarray, travel: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # pragma: no cover
    position, keep, slope = np.empty_like(signal), np.empty_like(signal), np.empty_like(signal)
    for channel in range(signal.shape[1]):
        before = z = 0.0
        for time in range(len(signal)):
            step = signal[time, channel] - before
            direction = float(np.sign(step))
            kept = math.exp(-abs(step) / travel[channel])
            keep[time, channel] = kept
            slope[time, channel] = (1.0 - direction * z) * kept / travel[channel]
            z = direction + (z - direction) * kept
            position[time, channel] = z
            before = signal[time, channel]
    return position, keep, slope


@njit(cache=True)
def _recursion(keep: np.ndarray, forcing: np.ndarray) -> np.ndarray:  # pragma: no cover
    """x_k = keep_k x_(k-1) + forcing_k from rest."""
    result = np.empty_like(forcing)
    state = np.zeros(forcing.shape[1:])
    for time in range(len(forcing)):
        for channel in range(forcing.shape[1]):
            for column in range(forcing.shape[2]):
                state[channel, column] = keep[time, channel] * state[channel, column] + forcing[time, channel, column]
        result[time] = state
    return result
