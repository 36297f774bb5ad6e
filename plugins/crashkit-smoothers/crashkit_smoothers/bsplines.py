"""Compiled kernels: B-splines on their knots, the samples' equations for their coefficients, and the values they give.

Within an interval of the knots a spline is a polynomial in u, from -1 at its left end to 1 at its right: the samples of an
interval are compressed as such, however many they are, before they are told to the coefficients.
"""

import math

import numpy as np
from numba import njit

from crashkit_smoothers.banded import reflect_in

CHUNK = 256
"""Samples that are reflected at once: few enough to stay in the processor's cache."""


@njit(cache=True)
def spline_row(x: float, interval: int, knots: np.ndarray, order: int, row: np.ndarray) -> None:  # pragma: no cover
    """The derivatives at x of those B-splines that are not zero on knots[interval] <= x <= knots[interval + 1].

    De Boor's recursion raises the degree; the last `order` steps differentiate.

    Arguments:
        order: of the derivative.
        row: (degree + 1,), overwritten.
    """
    degree = len(row) - 1
    row.fill(0.0)
    row[degree] = 1.0
    for raised in range(1, degree + 1):
        carried = 0.0
        for k in range(raised):
            right, left = knots[interval + k + 1], knots[interval + k + 1 - raised]
            share = row[degree - raised + k + 1] / (right - left)
            if raised <= degree - order:
                row[degree - raised + k] = carried + (right - x) * share
                carried = (x - left) * share
            else:
                row[degree - raised + k] = carried - raised * share
                carried = raised * share
        row[degree] = carried


@njit(cache=True)
def polynomials(interval: int, knots: np.ndarray, degree: int) -> np.ndarray:  # pragma: no cover
    """The B-splines on an interval as polynomials in u: [r, k] is the factor of u^r in the k-th of them."""
    half = 0.5 * (knots[interval + 1] - knots[interval])
    factors, scale = np.empty((degree + 1, degree + 1)), 1.0
    for r in range(degree + 1):
        spline_row(knots[interval] + half, interval, knots, r, factors[r])
        for k in range(degree + 1):
            factors[r, k] *= scale
        scale *= half / (r + 1)
    return factors


@njit(cache=True)
def roughness(knots: np.ndarray, order: int, points: np.ndarray, weights: np.ndarray) -> np.ndarray:  # pragma: no cover
    """Columns whose squares sum to the integral of (f^(order))^2, f a spline of degree 2 order - 1 with these knots.

    Arguments:
        points, weights: of Gauss on [-1, 1]; as many as `order` are exact, as the squares are of degree 2 order - 2.

    Returns:
        (interval, coefficient, point): [j, :, g] acts on the coefficients from j on.
    """
    degree = 2 * order - 1
    columns, row = np.zeros((len(knots) - 2 * degree - 1, degree + 1, len(points))), np.empty(degree + 1)
    for j in range(len(columns)):
        start, half = knots[j + degree], 0.5 * (knots[j + degree + 1] - knots[j + degree])
        if half > 0.0:
            for g in range(len(points)):
                spline_row(start + half * (1.0 + points[g]), j + degree, knots, order, row)
                for k in range(degree + 1):
                    columns[j, k, g] = row[k] * math.sqrt(half * weights[g])
    return columns


@njit(cache=True)
def compress(
    x: np.ndarray, z: np.ndarray, scale: np.ndarray, knots: np.ndarray, degree: int
) -> tuple[np.ndarray, np.ndarray, float]:  # pragma: no cover
    """The equations scale_i (f(x_i) - z_i) = 0 as a triangle: R, its right side, and the sum of squares that is left."""
    count, width = len(knots) - degree - 1, degree + 1
    triangle, right, rest = np.zeros((count, width)), np.zeros(count), 0.0
    local, side, block = np.empty((width, width)), np.empty(width), np.empty((width, width))
    powers, values = np.empty((width, CHUNK)), np.empty(CHUNK)
    first, last = 0, 0
    for interval in range(degree, count):
        start, half = knots[interval], 0.5 * (knots[interval + 1] - knots[interval])
        while last < len(x) and (x[last] < knots[interval + 1] or interval == count - 1):
            last += 1
        local.fill(0.0)
        side.fill(0.0)
        for begin in range(first, last, CHUNK):
            rows = min(CHUNK, last - begin)
            for i in range(rows):
                u = (x[begin + i] - start) / half - 1.0
                powers[0, i] = scale[begin + i]
                for r in range(1, width):
                    powers[r, i] = powers[r - 1, i] * u
                values[i] = scale[begin + i] * z[begin + i]
            rest += reflect_in(local, side, 0, powers, values, rows)
        if last > first:
            _by_spline(local, polynomials(interval, knots, degree), block)
            rest += reflect_in(triangle, right, interval - degree, block, side, width)
        first = last
    return triangle, right, rest


@njit(cache=True)
def _by_spline(local: np.ndarray, factors: np.ndarray, block: np.ndarray) -> None:  # pragma: no cover
    """Equations for a polynomial's factors, a triangle, as equations for the B-splines' coefficients: [k, i]."""
    width = len(local)
    for k in range(width):
        for i in range(width):
            block[k, i] = 0.0
            for m in range(width - i):
                block[k, i] += local[i, m] * factors[i + m, k]


@njit(cache=True)
def evaluate(
    x: np.ndarray, knots: np.ndarray, c: np.ndarray, inverse: np.ndarray, orders: int
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover
    """A spline and its first derivatives at sorted x, and their variances for a covariance Z of c.

    Arguments:
        inverse: the band of Z.
        orders: how many, the value among them.

    Returns:
        Both (orders, len(x)).
    """
    count, width = inverse.shape
    values, variances = np.empty((orders, len(x))), np.empty((orders, len(x)))
    factors, covariance = np.empty(width), np.empty((width, width))
    first, last = 0, 0
    for interval in range(width - 1, count):
        while last < len(x) and (x[last] < knots[interval + 1] or interval == count - 1):
            last += 1
        if last > first:
            start, half = knots[interval], 0.5 * (knots[interval + 1] - knots[interval])
            u = np.empty(last - first)
            for i in range(last - first):
                u[i] = (x[first + i] - start) / half - 1.0
            _as_polynomial(interval, knots, c, inverse, factors, covariance)
            for order in range(orders):
                _horner(factors, u, values[order, first:last])
                _horner(_square(covariance), u, variances[order, first:last])
                _differentiate(factors, covariance, half)
        first = last
    return values, variances


@njit(cache=True)
def _horner(factors: np.ndarray, u: np.ndarray, values: np.ndarray) -> None:  # pragma: no cover
    """sum factors_r u^r."""
    values.fill(factors[-1])
    for r in range(len(factors) - 2, -1, -1):
        for i in range(len(u)):
            values[i] = values[i] * u[i] + factors[r]


@njit(cache=True)
def _square(covariance: np.ndarray) -> np.ndarray:  # pragma: no cover
    """The variance of a polynomial as a polynomial: sum covariance_ab u^(a + b)."""
    factors = np.zeros(2 * len(covariance) - 1)
    for a in range(len(covariance)):
        for b in range(len(covariance)):
            factors[a + b] += covariance[a, b]
    return factors


@njit(cache=True)
def _differentiate(factors: np.ndarray, covariance: np.ndarray, half: float) -> None:  # pragma: no cover
    """A polynomial in u and the covariance of its factors become those of its derivative by x, in place."""
    top = len(factors) - 1
    for a in range(top):
        factors[a] = factors[a + 1] * (a + 1) / half
        for b in range(top):
            covariance[a, b] = covariance[a + 1, b + 1] * (a + 1) * (b + 1) / half**2
    factors[top] = 0.0
    for a in range(top + 1):
        covariance[a, top] = covariance[top, a] = 0.0


@njit(cache=True)
def _as_polynomial(
    interval: int, knots: np.ndarray, c: np.ndarray, inverse: np.ndarray, factors: np.ndarray, covariance: np.ndarray
) -> None:  # pragma: no cover
    """The spline on an interval as a polynomial in u: its factors and their covariance, overwritten."""
    width = len(factors)
    first = interval - width + 1
    by_power = polynomials(interval, knots, width - 1)
    half_way = np.zeros((width, width))
    for a in range(width):
        factors[a] = 0.0
        for k in range(width):
            factors[a] += by_power[a, k] * c[first + k]
            for m in range(width):
                half_way[a, k] += by_power[a, m] * inverse[first + min(k, m), abs(k - m)]
    for a in range(width):
        for b in range(width):
            covariance[a, b] = 0.0
            for k in range(width):
                covariance[a, b] += half_way[a, k] * by_power[b, k]
