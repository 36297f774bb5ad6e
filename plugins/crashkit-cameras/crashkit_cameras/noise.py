"""The noise of image readings, from what is left of them once cameras and points are fitted."""

import numpy as np
from scipy.optimize import brentq

from crashkit_cameras.bundle import Estimate, Readings, normal_equations
from crashkit_cameras.prior import Expectation
from crashkit_cameras.projection import Cameras

USUAL = 0.3
"""pixel; what reading an image usually is good for."""
SPREAD = 1.0
"""Standard deviation of the logarithm of the noise about that, before anything is measured."""
LIKENESS = 0.5
"""Standard deviation of the logarithm of a view's noise about that of all views."""
MEDIAN = 2.0 * np.log(2.0)
"""Of the square of two normal errors of variance 1."""
FAR = 25.0
"""The squared residual, in variances of a residual, from which a reading counts as a blunder."""
LEAST = 1e-6
"""pixel; images made without noise still have the resolution of their numbers."""


def first_std(cameras: Cameras, readings: Readings) -> np.ndarray:
    """A standard deviation to begin with, (view, point): the usual, or what the median residual of all asks for."""
    square = (readings.residuals(cameras, readings.known) ** 2).sum(axis=2) * readings.std**2
    median = np.sqrt(np.median(square[readings.seen]) / MEDIAN)
    return np.full_like(readings.std, max(USUAL, median))


def blunders(estimate: Estimate, readings: Readings, expectation: Expectation) -> tuple[np.ndarray, np.ndarray]:
    """Which readings are off by far more than the noise, and how many coordinates of each the fit left over."""
    equations = normal_equations(estimate.cameras, estimate.points, readings, expectation)
    left = np.where(readings.seen, np.maximum(equations.redundancy(), 0.0), 0.0)
    square = (readings.residuals(estimate.cameras, estimate.points) ** 2).sum(axis=2)
    return square > FAR * np.maximum(0.5 * left, 0.05), left


def updated_std(estimate: Estimate, readings: Readings, expectation: Expectation, control: np.ndarray) -> np.ndarray:
    """The standard deviation of each reading, (view, point), from what is left of them.

    Control points: Σ r² / Σ (2 - h) for each view, h the share of a reading that the fit used up (Foerstner's components
    of variance), drawn towards that of all views, as a view has few. Markers: the same multiple of it in all views, as two
    views cannot tell which of them is the noisier. Blunders do not count.

    Arguments:
        estimate: with the readings' present `std`.
        control: (point,), which are control points.
    """
    wrong, left = blunders(estimate, readings, expectation)
    square = (readings.residuals(estimate.cameras, estimate.points) ** 2).sum(axis=2) * readings.std**2
    square, left = np.where(wrong, 0.0, square), np.where(wrong, 0.0, left)
    sums = list(zip(square[:, control].sum(axis=1), left[:, control].sum(axis=1), strict=True))
    alone = [_most_probable(total, count, USUAL, SPREAD) for total, count in sums]
    common = float(np.exp(np.mean(np.log(alone))))
    view_std = np.array([_most_probable(total, count, common, LIKENESS) for total, count in sums])[:, None]
    relative = square[:, ~control] / view_std**2
    multiple = _most_probable(relative.sum(), left[:, ~control].sum(), 1.0, SPREAD)
    return np.maximum(np.where(control, view_std, multiple * view_std), LEAST)


def _most_probable(square: float, count: float, usual: float, spread: float) -> float:
    """The standard deviation from a sum of squares of so many readings, and from what is usual; LEAST or more."""

    def slope(logarithm: float) -> float:
        return float(count - square * np.exp(-2.0 * logarithm) + (logarithm - np.log(usual)) / spread**2)

    if slope(np.log(LEAST)) >= 0.0:
        return LEAST
    return float(np.exp(brentq(slope, np.log(LEAST), np.log(usual + np.sqrt(square / max(count, 1.0))))))
