"""Quintic splines on chosen knots: their basis, their derivatives, and the roughness that a smoothing spline penalises."""

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline

DEGREE = 5
CLOSEST = 0.2  # distance of two knots, of the mean distance if there are as many as allowed
ROUGHNESS_ORDER = 3  # of the derivative whose square is penalised: q of Mizzi & Jezequel 1992, eq 31


def knot_vector(x: np.ndarray, interior: int) -> np.ndarray:
    """Knots at no more than `interior` of the samples, as dense as these are, over all of [0, 1].

    A sample too close after a knot gets none: second differences over the gap would lose the digits of a derivative.

    Arguments:
        x: (sample,), strictly increasing, in [0, 1].
        interior: the largest number of knots within ]0, 1[.
    """
    chosen = np.unique(np.linspace(0, len(x) - 1, interior + 2).round().astype(int))
    closest = CLOSEST / interior
    inner = [0.0]
    for place in x[chosen]:
        if inner[-1] + closest <= place <= 1.0 - closest:
            inner.append(float(place))
    return np.concatenate([np.zeros(DEGREE + 1), inner[1:], np.ones(DEGREE + 1)])


def basis(x: np.ndarray, knots: np.ndarray, order: int = 0) -> sparse.csr_array:
    """The B-splines of a derivative of that order, of degree 5 - order, at every x: (len(x), coefficient - order)."""
    return sparse.csr_array(BSpline.design_matrix(x, knots[order : len(knots) - order], DEGREE - order))


def differentiation(knots: np.ndarray, order: int) -> sparse.csr_array:
    """From the coefficients of a spline to those of its derivative: (coefficient - order, coefficient).

    c'_i = k (c_{i+1} - c_i) / (t_{i+k+1} - t_{i+1}) for a spline of degree k, again and again.
    """
    operator = sparse.eye_array(len(knots) - DEGREE - 1, format="csr")
    for lowered in range(order):
        degree = DEGREE - lowered
        inner = knots[lowered + 1 : len(knots) - lowered - 1]
        slopes = degree / (inner[degree:] - inner[:-degree])
        operator = sparse.diags_array([-slopes, slopes], offsets=[0, 1], shape=(len(slopes), len(slopes) + 1)) @ operator
    return operator


def roughness(knots: np.ndarray) -> sparse.csr_array:
    """The integrals over [0, 1] of the products of the B-splines' third derivatives: (coefficient, coefficient).

    Three Gauss points on each interval are exact: the products are of degree four.
    """
    points, weights = np.polynomial.legendre.leggauss(3)
    edges = np.unique(knots)
    half = 0.5 * np.diff(edges)[:, None]
    x = (edges[:-1, None] + half * (1.0 + points)).ravel()
    third = basis(x, knots, ROUGHNESS_ORDER) @ differentiation(knots, ROUGHNESS_ORDER)
    return third.T @ sparse.diags_array((half * weights).ravel()) @ third
