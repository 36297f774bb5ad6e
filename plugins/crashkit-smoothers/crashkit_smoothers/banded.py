"""Compiled kernels: least squares in a banded basis by reflections, and the band of an inverse.

An upper triangle R of w diagonals is kept as triangle[j, m] = R[j, j + m], a symmetric matrix as band[j, m] = M[j, j + m].
Reflections work on the equations, not on products of them, which would lose half of the digits (Cox 1981,
doi:10.1093/imanum/1.1.3).
"""

import math

import numpy as np
from numba import njit

ANY_ORDER = {"reassoc", "contract"}
"""Sums may be taken in any order, so that they use the processor's vectors."""


@njit(cache=True, fastmath=ANY_ORDER)
def reflect_in(
    triangle: np.ndarray, right: np.ndarray, start: int, block: np.ndarray, values: np.ndarray, rows: int
) -> float:  # pragma: no cover
    """Householder reflections of some equations, sum_k block[k, i] c[start + k] = values[i], into R c = right.

    Blocks come in the order of `start`; both are overwritten.

    Arguments:
        rows: how many equations there are; the block may have room for more.

    Returns:
        The sum of squares of what is left of `values`, which no c can satisfy.
    """
    reach = min(len(block), len(right) - start)
    for k in range(reach):
        squares = 0.0
        for i in range(rows):
            squares += block[k, i] * block[k, i]
        if squares > 0.0:
            size = -math.copysign(math.sqrt(triangle[start + k, 0] ** 2 + squares), triangle[start + k, 0])
            first = triangle[start + k, 0] - size
            triangle[start + k, 0] = size
            for m in range(k + 1, reach):
                above = triangle[start + k, m - k]
                triangle[start + k, m - k] += first * _reflect(block[k], block[m], rows, first, above, size)
            right[start + k] += first * _reflect(block[k], values, rows, first, right[start + k], size)
    rest = 0.0
    for i in range(rows):
        rest += values[i] * values[i]
    return rest


@njit(cache=True, fastmath=ANY_ORDER)
def _reflect(
    pivot: np.ndarray, column: np.ndarray, rows: int, first: float, above: float, size: float
) -> float:  # pragma: no cover
    """Reflect one column by the vector (first, pivot); returns the vector's factor."""
    product = first * above
    for i in range(rows):
        product += pivot[i] * column[i]
    factor = product / (size * first)
    for i in range(rows):
        column[i] += factor * pivot[i]
    return factor


@njit(cache=True)
def penalise(
    triangle: np.ndarray, right: np.ndarray, penalty: np.ndarray, weight: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:  # pragma: no cover
    """The triangle of R c = right together with weight[j] penalty[j, k, g] c[j + k] = 0: its band and its right side."""
    count, width = triangle.shape
    points = penalty.shape[2]
    factor, side = np.zeros((count, width)), np.zeros(count)
    block, values = np.empty((width, points + 1)), np.empty(points + 1)
    for j in range(count):
        for k in range(width):
            block[k, 0] = triangle[j, k]
            for g in range(points):
                block[k, g + 1] = weight[j] * penalty[j, k, g] if j < len(penalty) else 0.0
        values.fill(0.0)
        values[0] = right[j]
        reflect_in(factor, side, j, block, values, points + 1)
    return factor, side


@njit(cache=True)
def solve(triangle: np.ndarray, right: np.ndarray) -> np.ndarray:  # pragma: no cover
    """c of R c = right."""
    count, width = triangle.shape
    c = np.empty(count)
    for j in range(count - 1, -1, -1):
        total = right[j]
        for m in range(1, min(width, count - j)):
            total -= triangle[j, m] * c[j + m]
        c[j] = total / triangle[j, 0]
    return c


@njit(cache=True)
def inverse_band(triangle: np.ndarray) -> np.ndarray:  # pragma: no cover
    """The band of Z = (R'R)^-1, from R Z = R'^-1, whose band is 1 / R[j, j]: from the last row to the first.

    Hutchinson & de Hoog 1985, doi:10.1007/BF01389878.
    """
    count, width = triangle.shape
    inverse = np.zeros((count, width))
    for j in range(count - 1, -1, -1):
        reach = min(width, count - j)
        for r in range(reach - 1, -1, -1):
            total = 1.0 / triangle[j, 0] if r == 0 else 0.0
            for m in range(1, reach):
                total -= triangle[j, m] * inverse[j + min(r, m), abs(r - m)]
            inverse[j, r] = total / triangle[j, 0]
    return inverse


@njit(cache=True)
def trace(triangle: np.ndarray, inverse: np.ndarray) -> float:  # pragma: no cover
    """tr(R'R Z), with R a triangle and Z the band of a symmetric matrix."""
    count, width = triangle.shape
    total = 0.0
    for j in range(count):
        for a in range(min(width, count - j)):
            total += triangle[j, a] ** 2 * inverse[j + a, 0]
            for b in range(a):
                total += 2.0 * triangle[j, a] * triangle[j, b] * inverse[j + b, a - b]
    return total


@njit(cache=True)
def distance(triangle: np.ndarray, right: np.ndarray, c: np.ndarray) -> float:  # pragma: no cover
    """|R c - right|^2."""
    count, width = triangle.shape
    total = 0.0
    for j in range(count):
        apart = -right[j]
        for m in range(min(width, count - j)):
            apart += triangle[j, m] * c[j + m]
        total += apart**2
    return total
