"""The best linear estimate of a state from all of a record, with its covariance."""

import numpy as np
from numba import njit


@njit(cache=True)
def smoothed(
    transition: np.ndarray, noise: np.ndarray, push: np.ndarray, seen: np.ndarray, readings: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover
    """The state x_(k+1) = transition_k x_k + push_k + noise_k, x_0 = 0, given readings_k = seen_k x_k + noise of variance 1.

    Arguments:
        transition, noise: (time - 1, state, state), noise as covariance.
        push: (time - 1, state).
        seen: (time, reading, state).
        readings: (time, reading).

    Returns:
        The mean (time, state) and the covariance (time, state, state) given all readings.

    Bierman, Fixed interval smoothing with discrete measurements, International Journal of Control 18 (1973) 65.
    """
    count, states = len(seen), transition.shape[1]
    mean, covariance = np.zeros((count, states)), np.zeros((count, states, states))
    gain = np.empty((count, states, readings.shape[1]))
    surprise, certainty = np.empty_like(readings), np.empty((count, readings.shape[1], readings.shape[1]))
    for k in range(count):
        certainty[k] = np.linalg.inv(seen[k] @ covariance[k] @ seen[k].T + np.eye(readings.shape[1]))
        surprise[k] = certainty[k] @ (readings[k] - seen[k] @ mean[k])
        gain[k] = covariance[k] @ seen[k].T @ certainty[k]
        if k < count - 1:
            now = mean[k] + covariance[k] @ seen[k].T @ surprise[k]
            spread = covariance[k] - gain[k] @ seen[k] @ covariance[k]
            mean[k + 1] = transition[k] @ now + push[k]
            covariance[k + 1] = transition[k] @ spread @ transition[k].T + noise[k]
    pull, weight = np.zeros(states), np.zeros((states, states))
    for k in range(count - 1, -1, -1):
        kept = np.eye(states) - gain[k] @ seen[k]
        pull = kept.T @ pull - seen[k].T @ surprise[k]
        weight = kept.T @ weight @ kept + seen[k].T @ certainty[k] @ seen[k]
        mean[k] -= covariance[k] @ pull
        covariance[k] -= covariance[k] @ weight @ covariance[k]
        if k:
            pull = transition[k - 1].T @ pull
            weight = transition[k - 1].T @ weight @ transition[k - 1]
    return mean, covariance
