"""ISO/TS 18571: how well a simulated curve matches a recorded one, rated from 0 to 1."""

import math

import numpy as np
from attrs import frozen
from numba import njit

INTERVAL = 1e-4  # s: the standard rates curves at 10 kHz
LARGEST_SHIFT = 0.2  # of the curve's length
WARPING_WINDOW = 0.1  # of the curve's length
INNER_CORRIDOR, OUTER_CORRIDOR = 0.05, 0.5  # of the largest absolute value of the reference
LARGEST_MAGNITUDE_ERROR = 0.5
LARGEST_SLOPE_ERROR = 2.0
SHORTEST = 12  # samples: with fewer the slope's nine-point average does not fit into a shifted curve


@frozen
class Rating:
    """Scores from 0 (no match) to 1 (perfect); NaN where the reference does not vary."""

    total: float
    corridor: float
    phase: float
    magnitude: float
    slope: float


UNRATED = Rating(math.nan, math.nan, math.nan, math.nan, math.nan)


def rating(reference: np.ndarray, simulated: np.ndarray, interval: float) -> Rating:
    """The objective rating of ISO/TS 18571:2014.

    R = 0.4 corridor + 0.2 phase + 0.2 magnitude + 0.2 slope

    Curves are resampled to 10 kHz and missing samples interpolated first.

    Arguments:
        reference, simulated: (time,), in the same unit; NaN where a sample is missing.
        interval: s, between samples.
    """
    reference, simulated = _prepared(reference, interval), _prepared(simulated, interval)
    if len(reference) < SHORTEST or np.isnan(simulated).any() or not np.ptp(reference) > 0:
        return UNRATED
    shift = _best_shift(reference, simulated, int(LARGEST_SHIFT * len(reference)))
    shifted_reference, shifted_simulated = _shifted(reference, simulated, shift)
    corridor = _corridor(reference, simulated)
    phase = max(0.0, 1.0 - abs(shift) / (LARGEST_SHIFT * len(reference)))
    magnitude = _magnitude(shifted_reference, shifted_simulated)
    slope = _slope(shifted_reference, shifted_simulated)
    return Rating(0.4 * corridor + 0.2 * (phase + magnitude + slope), corridor, phase, magnitude, slope)


def _prepared(samples: np.ndarray, interval: float) -> np.ndarray:
    """Samples at 10 kHz without gaps; all NaN if there is no sample."""
    samples = np.asarray(samples, float)
    present = np.isfinite(samples)
    if present.all() and math.isclose(interval, INTERVAL, rel_tol=1e-6):
        return samples
    times = interval * np.arange(len(samples))
    count = round(times[-1] / INTERVAL) + 1 if len(samples) else 0
    if not present.any():
        return np.full(count, np.nan)
    return np.interp(INTERVAL * np.arange(count), times[present], samples[present])


def _shifted(reference: np.ndarray, simulated: np.ndarray, shift: int) -> tuple[np.ndarray, np.ndarray]:
    """The overlap of both curves, with `simulated` moved by `shift` samples (positive: to earlier times)."""
    if shift > 0:
        return reference[:-shift], simulated[shift:]
    if shift < 0:
        return reference[-shift:], simulated[:shift]
    return reference, simulated


def _corridor(reference: np.ndarray, simulated: np.ndarray) -> float:
    """1 inside the inner corridor, 0 outside the outer one, quadratic between them."""
    distance = np.abs(reference - simulated) / np.abs(reference).max()
    inside = np.clip((OUTER_CORRIDOR - distance) / (OUTER_CORRIDOR - INNER_CORRIDOR), 0.0, 1.0)
    return float(np.mean(inside**2))


def _magnitude(reference: np.ndarray, simulated: np.ndarray) -> float:
    window = math.ceil(WARPING_WINDOW * len(reference)) - 1
    error, size = _warped_error(reference, simulated, window)
    return _score(error, size, LARGEST_MAGNITUDE_ERROR)


def _slope(reference: np.ndarray, simulated: np.ndarray) -> float:
    slope, simulated_slope = _smoothed(np.gradient(reference)), _smoothed(np.gradient(simulated))
    return _score(float(np.abs(simulated_slope - slope).sum()), float(np.abs(slope).sum()), LARGEST_SLOPE_ERROR)


def _score(error: float, size: float, largest: float) -> float:
    """1 without error, 0 where error / size reaches `largest`."""
    if size == 0:
        return float(error == 0)
    return max(0.0, 1.0 - error / size / largest)


def _smoothed(slope: np.ndarray) -> np.ndarray:
    """Moving average over nine points, over seven, five, three and one towards the ends."""
    smooth = np.convolve(slope, np.full(9, 1 / 9), mode="same")
    for index in range(4):
        width = 2 * index + 1
        smooth[index], smooth[-index - 1] = slope[:width].mean(), slope[-width:].mean()
    return smooth


@njit(cache=True)
def _best_shift(reference: np.ndarray, simulated: np.ndarray, limit: int) -> int:
    """The shift of highest correlation in samples; the smallest of several, to earlier times first."""
    best, highest = 0, _correlation(reference, simulated)
    for shift in range(1, limit + 1):
        for signed in (shift, -shift):
            if signed > 0:
                correlation = _correlation(reference[:-shift], simulated[shift:])
            else:
                correlation = _correlation(reference[shift:], simulated[:-shift])
            # Beyond rounding, so that straight lines, which correlate perfectly at any shift, are not shifted.
            if correlation > highest + 1e-12:
                best, highest = signed, correlation
    return best


@njit(cache=True)
def _correlation(x: np.ndarray, y: np.ndarray) -> float:
    """Pearson's coefficient; -1 where a curve does not vary, so that it is never chosen."""
    mean_x, mean_y = x.mean(), y.mean()
    xx, yy, xy = 0.0, 0.0, 0.0
    for i in range(len(x)):
        dx, dy = x[i] - mean_x, y[i] - mean_y
        xx += dx * dx
        yy += dy * dy
        xy += dx * dy
    return xy / math.sqrt(xx * yy) if xx * yy > 0 else -1.0


@njit(cache=True)
def _warped_error(reference: np.ndarray, simulated: np.ndarray, window: int) -> tuple[float, float]:
    """Sums of |simulated - reference| and of |reference| along the path of dynamic time warping.

    Both sums travel with the cheapest path, so that two rows of the cost matrix are enough; column 0 is a border.
    """
    count = len(reference)
    cost = np.full((2, count + 1), np.inf)
    error, size = np.zeros((2, count + 1)), np.zeros((2, count + 1))
    cost[1, 0] = 0.0
    for i in range(count):
        row, above = i % 2, (i + 1) % 2
        cost[row] = np.inf
        for j in range(max(0, i - window), min(count, i + window + 1)):
            previous, column = above, j + 1
            if cost[row, j] < cost[previous, column]:
                previous, column = row, j
            if cost[above, j] < cost[previous, column]:
                previous, column = above, j
            difference = abs(simulated[i] - reference[j])
            cost[row, j + 1] = cost[previous, column] + difference**2
            error[row, j + 1] = error[previous, column] + difference
            size[row, j + 1] = size[previous, column] + abs(reference[j])
    last = (count - 1) % 2
    return error[last, count], size[last, count]
