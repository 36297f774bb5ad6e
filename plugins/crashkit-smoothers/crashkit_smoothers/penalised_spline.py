"""A spline that follows samples and pays for its roughness, for any weight of that roughness."""

from typing import Self

import numpy as np
from attrs import field, frozen
from numpy.polynomial.legendre import leggauss

from crashkit_smoothers.banded import distance, inverse_band, penalise, solve, trace
from crashkit_smoothers.bsplines import compress, evaluate, roughness


@frozen
class Fit:
    """A fit with one smoothing.

    Attributes:
        coefficients: of the B-splines, (coefficient,).
        inverse: the band of their covariance, for samples whose scaled standard deviation is 1.
        smoothing: the weight of the roughness.
        freedom: effective degrees of freedom, the trace of the influence matrix.
        residual: sum of squares, scaled.
    """

    coefficients: np.ndarray
    inverse: np.ndarray
    smoothing: float
    freedom: float
    residual: float


@frozen
class PenalisedSpline:
    """Minimises sum (scale_i (z_i - f(x_i)))^2 + smoothing integral stiffness (f^(order))^2 dx, f of degree 2 order - 1.

    The samples are read once: what they say of the coefficients is a banded triangle, however many they are.

    Attributes:
        knots: with the ends repeated.
        order: q of the derivative that is penalised.
        mass: sum of scale_i^2.
        stiffness: (interval,) of the knots.
        triangle, right, rest: of the samples' equations.
        columns: of the roughness, (interval, coefficient, point).
    """

    knots: np.ndarray
    order: int
    mass: float
    triangle: np.ndarray
    right: np.ndarray
    rest: float
    stiffness: np.ndarray
    columns: np.ndarray = field(init=False)

    def __attrs_post_init__(self) -> None:
        object.__setattr__(self, "columns", roughness(self.knots, self.order, *leggauss(self.order)))

    @classmethod
    def of(cls, x: np.ndarray, z: np.ndarray, scale: np.ndarray, knots: np.ndarray, order: int, rounding: float = 0.0) -> Self:
        """From samples z at sorted x, whose rounding adds so much to the sum of squares."""
        triangle, right, rest = compress(x, z, scale, knots, 2 * order - 1)
        stiffness = np.ones(len(knots) - 4 * order + 1)
        return cls(knots, order, float(np.sum(scale**2)), triangle, right, rest + rounding, stiffness)

    def with_smoothing(self, smoothing: float) -> Fit:
        """The fit with this weight of the roughness."""
        factor, side = penalise(self.triangle, self.right, self.columns, np.sqrt(smoothing * self.stiffness))
        coefficients, inverse = solve(factor, side), inverse_band(factor)
        residual = self.rest + distance(self.triangle, self.right, coefficients)
        return Fit(coefficients, inverse, smoothing, trace(self.triangle, inverse), residual)

    def evaluated(self, x: np.ndarray, fit: Fit, orders: int = 3) -> tuple[np.ndarray, np.ndarray]:
        """The value and derivatives of a fit at sorted x, and their standard deviations: both (orders, len(x))."""
        values, variances = evaluate(x, self.knots, fit.coefficients, fit.inverse, orders)
        return values, np.sqrt(np.maximum(variances, 0.0, out=variances), out=variances)

    def roughness_of(self, fit: Fit) -> np.ndarray:
        """The mean of (f^(order))^2 on each interval of the knots; 0 on an empty one."""
        intervals, width, _ = self.columns.shape
        reached = fit.coefficients[np.arange(intervals)[:, None] + np.arange(width)]
        lengths = np.diff(self.knots[width - 1 : len(self.knots) - width + 1])
        squares = np.einsum("jkg,jk->jg", self.columns, reached) ** 2
        return squares.sum(axis=1) / np.where(lengths > 0.0, lengths, 1.0)
