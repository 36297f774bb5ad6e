"""ISO/TS 18571: how well a simulated curve matches a recorded one, rated from 0 to 1."""

import math

import numpy as np
from attrs import frozen
from numba import njit
from scipy.fft import irfft, next_fast_len, rfft

INTERVAL = 1e-4  # s: the standard rates curves at 10 kHz
LARGEST_SHIFT = 0.2  # of the curve's length
WARPING_WINDOW = 0.1  # of the curve's length
INNER_CORRIDOR, OUTER_CORRIDOR = 0.05, 0.5  # of the largest absolute value of the reference
LARGEST_MAGNITUDE_ERROR = 0.5
LARGEST_SLOPE_ERROR = 2.0
ROUNDING = 1e-6  # of a correlation by Fourier transform
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


def _best_shift(reference: np.ndarray, simulated: np.ndarray, limit: int) -> int:
    """The shift of highest correlation in samples; the smallest of several, to earlier times first."""
    shifts = np.array([0, *(signed for shift in range(1, limit + 1) for signed in (shift, -shift))])
    roughly = _correlations(reference, simulated, shifts)
    best, highest = 0, -math.inf
    for shift in shifts[roughly >= roughly.max() - ROUNDING].tolist():
        correlation = _correlation(*_shifted(reference, simulated, shift))
        # Beyond rounding, so that straight lines, which correlate perfectly at any shift, are not shifted.
        if correlation > highest + 1e-12:
            best, highest = shift, correlation
    return best


def _correlations(x: np.ndarray, y: np.ndarray, shifts: np.ndarray) -> np.ndarray:
    """Pearson's coefficient of the overlap at every shift, but for rounding: by Fourier transform."""
    x, y, size = x - x.mean(), y - y.mean(), next_fast_len(2 * len(x), real=True)
    products = irfft(rfft(y, size) * rfft(x, size).conj(), size)[shifts]
    count = len(x) - np.abs(shifts)
    sum_x, square_x = (_sums(x**power, np.maximum(-shifts, 0), count) for power in (1, 2))
    sum_y, square_y = (_sums(y**power, np.maximum(shifts, 0), count) for power in (1, 2))
    spread = np.maximum((square_x - sum_x**2 / count) * (square_y - sum_y**2 / count), 0.0)
    found = np.full(len(shifts), -1.0)
    return np.divide(products - sum_x * sum_y / count, np.sqrt(spread), out=found, where=spread > 0.0)


def _sums(values: np.ndarray, start: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Of so many values from each start."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    total: np.ndarray = sums[start + count] - sums[start]
    return total


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

    Both sums travel with the cheapest path, so that one row of the cost matrix is enough; column 0 is a border.
    """
    count = len(reference)
    cost, error, size = np.full(count + 1, np.inf), np.zeros(count + 1), np.zeros(count + 1)
    cost[0] = 0.0
    for i in range(count):
        first, end = max(0, i - window), min(count, i + window + 1)
        across_cost, across_error, across_size = cost[first], error[first], size[first]
        left_cost, left_error, left_size = np.inf, 0.0, 0.0
        cost[first] = np.inf
        for j in range(first, end):
            above_cost, above_error, above_size = cost[j + 1], error[j + 1], size[j + 1]
            least, so_far, sized = above_cost, above_error, above_size
            if left_cost < least:
                least, so_far, sized = left_cost, left_error, left_size
            if across_cost < least:
                least, so_far, sized = across_cost, across_error, across_size
            difference = abs(simulated[i] - reference[j])
            left_cost, left_error, left_size = least + difference**2, so_far + difference, sized + abs(reference[j])
            cost[j + 1], error[j + 1], size[j + 1] = left_cost, left_error, left_size
            across_cost, across_error, across_size = above_cost, above_error, above_size
    return error[count], size[count]
