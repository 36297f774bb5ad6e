"""Smooth curves through samples: cubic B-splines with evenly spaced knots."""

import numpy as np
from scipy.interpolate import BSpline

DEGREE = 3
FEWEST = 6
GROWTH = 1.4
DENSEST = 0.4
"""Functions for each sample, at most."""
BRIDGE = 1e-6
"""Weight of smoothness against the samples: it only tells where there are none."""


def knots(start: float, end: float, count: int) -> np.ndarray:
    """The knots of `count` functions that cover a range of time, s."""
    step = (end - start) / (count - DEGREE)
    return start + step * np.arange(-DEGREE, count + 1)


def basis(over: np.ndarray, times: np.ndarray, derivative: int = 0) -> np.ndarray:
    """The functions that belong to knots, or a derivative of them, (time, function)."""
    return np.asarray(BSpline(over, np.eye(len(over) - DEGREE - 1), DEGREE)(times, derivative))


def bridge(functions: np.ndarray) -> np.ndarray:
    """A weak call for smoothness, beside the normal equations of the functions at the samples, (function, function)."""
    second = np.diff(np.eye(functions.shape[1]), 2, axis=0)
    return BRIDGE * np.mean(np.sum(functions**2, axis=0)) * second.T @ second


def through(functions: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Coefficients (function, ...) of the smooth curve nearest to samples (time, ...)."""
    return np.linalg.solve(functions.T @ functions + bridge(functions), functions.T @ samples)


def choose_count(times: np.ndarray, tracks: np.ndarray) -> tuple[int, np.ndarray]:
    """How many functions tracks (time, track) ask for, by Akaike's criterion over all, and the noise that remains in each.

    Samples may be NaN. A track with few samples has no say, and its noise is the median of the others'.
    """
    seen = np.isfinite(tracks).sum(axis=0)
    most = max(int(DENSEST * np.median(seen)), FEWEST)
    asked = tracks[:, seen > 1.5 * most]
    counts = np.unique(np.geomspace(FEWEST, most, 2 + int(np.log(most / FEWEST) / np.log(GROWTH))).astype(int))
    scores, noises = zip(*(_score(times, asked, int(count)) for count in counts), strict=True)
    best = int(np.argmin(scores))
    noise = np.full(tracks.shape[1], np.median(noises[best]))
    noise[seen > 1.5 * most] = noises[best]
    return int(counts[best]), noise


def _score(times: np.ndarray, tracks: np.ndarray, count: int) -> tuple[float, np.ndarray]:
    functions = basis(knots(times[0], times[-1], count), times)
    score, noise = 0.0, []
    for track in tracks.T:
        seen = np.isfinite(track)
        residual = track[seen] - functions[seen] @ through(functions[seen], track[seen])
        square = max(residual @ residual, np.finfo(float).tiny)
        score += seen.sum() * np.log(square / seen.sum()) + 2.0 * count
        noise.append(np.sqrt(square / (seen.sum() - count)))
    return score, np.array(noise)
