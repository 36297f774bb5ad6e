"""Sine series over equal samples, by fast transforms: values, derivatives and variances.

The n samples lie at x = (j + 1/2) / n of [0, 1], where the functions sqrt(2/n) sin(pi k x), k = 1 to n - 1, are orthonormal.
"""

import numpy as np
from scipy.fft import dct, dst


def amplitudes(values: np.ndarray) -> np.ndarray:
    """The amplitudes of values, (sample, ...), from k = 1 on: (n, ...); the last wave changes sign from sample to sample."""
    return dst(values, type=2, norm="ortho", axis=0)


def derivative(amplitude: np.ndarray, count: int, order: int) -> np.ndarray:
    """The derivative by x of that order, 0 to 2, of a series with these amplitudes, at all samples: (count, ...)."""
    k = np.arange(1, len(amplitude) + 1).reshape(-1, *[1] * (amplitude.ndim - 1))
    padded = np.zeros((count, *amplitude.shape[1:]))
    if order == 1:
        padded[1 : len(amplitude) + 1] = amplitude * np.pi * k
        return dct(padded, type=3, axis=0) / np.sqrt(2.0 * count)
    padded[: len(amplitude)] = amplitude * (-((np.pi * k) ** 2) if order == 2 else 1.0)
    return dst(padded, type=3, axis=0) / np.sqrt(2.0 * count)


def variance(power: np.ndarray, count: int, order: int) -> np.ndarray:
    """The variance of the derivative of that order where the amplitudes are independent with these variances: (count,).

    sin^2 = (1 - cos 2) / 2 and cos^2 = (1 + cos 2) / 2; beyond the highest frequency a cosine is the negative of another.
    """
    weights = power * (np.pi * np.arange(1, len(power) + 1)) ** (2 * order)
    doubled = np.zeros(count)
    low = weights[: (count - 1) // 2]
    doubled[2 : 2 * len(low) + 2 : 2] = low
    high = weights[count // 2 :]
    places = 2 * count - 2 * np.arange(count // 2 + 1, len(weights) + 1)
    doubled[places] -= high
    cosines = 0.5 * dct(doubled, type=3)
    return (weights.sum() + (cosines if order == 1 else -cosines)) / count
