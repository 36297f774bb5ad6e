"""One quintic spline through readings of a quantity and of its derivatives, smoothed as generalised cross-validation says."""

from collections.abc import Sequence

import numpy as np
from attrs import frozen
from scipy.interpolate import BSpline
from scipy.linalg import qr, solve_triangular, svd

DEGREE = 5
MOST_KNOTS = 300
"""Intervals of a spline: half a millisecond in a crash."""
SMOOTHINGS = np.logspace(-12.0, 6.0, 73)
"""Of the roughness against the misfit, as shares of their sizes."""


@frozen(eq=False)
class Reading:
    """Samples of a quantity (order 0) or of one of its derivatives, each as often as it tells something of its own."""

    order: int
    times: np.ndarray
    values: np.ndarray
    std: float


def enough(readings: Sequence[Reading]) -> bool:
    """Whether a spline can be put through the readings: accelerations alone leave open where and how fast all began."""
    positions, speeds = (sum(len(one.times) for one in readings if one.order == order) for order in (0, 1))
    return any(len(one.times) >= 2 * DEGREE for one in readings) and positions > 0 and positions + speeds > 1


def smoothed(readings: Sequence[Reading], times: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """The quantity, its first and its second derivative at `times`, each with its standard deviation; NaN after the readings.

    Minimises Σ ((z_i - f^(k)(t_i)) / s_i)² + p ∫ (f''')² dt over quintic splines f, with k the order of reading i, and p by
    generalised cross-validation.
    """
    stamps = np.unique(np.concatenate([reading.times for reading in readings]))
    span = (float(stamps[0]), max(float(stamps[-1]), float(times[-1])))
    count = min(len(stamps), MOST_KNOTS)
    knots = np.concatenate([[span[0]] * DEGREE, np.linspace(*span, count), [span[1]] * DEGREE])
    rows = np.concatenate([_basis(knots, r.times, r.order) / r.std for r in readings])
    target = np.concatenate([r.values / r.std for r in readings])
    coefficients, covariance = _fit(rows, target, _roughness(knots))
    inside = times <= stamps[-1]
    curves = []
    for order in range(3):
        at = _basis(knots, times, order)
        std = np.sqrt(np.maximum(((at @ covariance) * at).sum(axis=1), 0.0))
        curves.append((np.where(inside, at @ coefficients, np.nan), np.where(inside, std, np.nan)))
    return curves


def _basis(knots: np.ndarray, times: np.ndarray, order: int) -> np.ndarray:
    spline = BSpline(knots, np.eye(len(knots) - DEGREE - 1), DEGREE)
    return np.asarray(spline(times, nu=order))


def _roughness(knots: np.ndarray) -> np.ndarray:
    """Rows whose sum of squares is ∫ (f''')² dt: three points of Gauss in each interval are exact."""
    nodes, weights = np.polynomial.legendre.leggauss(3)
    ends = np.unique(knots)
    half = 0.5 * np.diff(ends)
    at = (0.5 * (ends[1:] + ends[:-1])[:, None] + half[:, None] * nodes).ravel()
    return _basis(knots, at, 3) * np.sqrt(half[:, None] * weights).ravel()[:, None]


def _fit(rows: np.ndarray, target: np.ndarray, roughness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of least penalised squares, with their covariance.

    By orthogonal factors: the squares of second derivatives and of a start that is known are too far apart to be added.
    """
    size = float(np.linalg.norm(rows) / np.linalg.norm(roughness))
    factor, triangle = qr(np.concatenate([rows, size * roughness]), mode="economic")
    # Not by division, which is faster and now and then does not converge.
    _, values, turns = svd(factor[len(rows) :], full_matrices=False, lapack_driver="gesvd")
    rough, vectors = np.minimum(values**2, 1.0), solve_triangular(triangle, turns.T)
    pulled, turned = vectors.T @ (rows.T @ target), rows @ vectors

    def gain(smoothing: float) -> np.ndarray:
        return 1.0 / np.maximum(1.0 - rough + smoothing * rough, 1e-300)

    def left(smoothing: float) -> tuple[float, float]:
        """The sum of squares that remains, and the number of readings not used up."""
        away = target - turned @ (gain(smoothing) * pulled)
        freedom = len(target) - float(((1.0 - rough) * gain(smoothing)).sum())
        return float(away @ away), max(freedom, 1.0)

    def score(smoothing: float) -> float:
        squares, freedom = left(smoothing)
        return squares / freedom**2

    best = min(SMOOTHINGS.tolist(), key=score)
    squares, freedom = left(best)
    return vectors @ (gain(best) * pulled), squares / freedom * (vectors * gain(best)) @ vectors.T
