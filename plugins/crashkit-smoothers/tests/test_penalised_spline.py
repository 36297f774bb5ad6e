"""The banded kernels against dense matrices on scipy's B-splines."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from crashkit_smoothers.knots import knot_vector
from crashkit_smoothers.penalised_spline import PenalisedSpline


def dense(spline: PenalisedSpline, x: np.ndarray, derivative: int = 0) -> np.ndarray:
    """Every B-spline's derivative at x: (len(x), coefficient)."""
    degree = 2 * spline.order - 1
    return BSpline(spline.knots, np.eye(len(spline.knots) - degree - 1), degree)(x, nu=derivative)


def dense_roughness(spline: PenalisedSpline) -> np.ndarray:
    """The integrals of the products of the derivatives that are penalised, with ten Gauss points on each interval."""
    degree = 2 * spline.order - 1
    edges = spline.knots[degree : len(spline.knots) - degree]
    points, weights = np.polynomial.legendre.leggauss(10)
    half = 0.5 * np.diff(edges)[:, None]
    x = edges[:-1, None] + half * (1.0 + points)
    factors = half * weights * spline.stiffness[:, None]
    keep = factors.ravel() > 0.0
    rows = dense(spline, x.ravel()[keep], spline.order)
    return rows.T @ (factors.ravel()[keep, None] * rows)


def test_the_roughness_of_a_fit_is_the_mean_square_of_its_derivative() -> None:
    x = np.linspace(0.0, 1.0, 50)
    spline = PenalisedSpline.of(x, x**3, np.ones(50), knot_vector(x, 5, 5, (0.5,)), 3)
    roughness = spline.roughness_of(spline.with_smoothing(1e-15))
    filled = np.diff(spline.knots[5:-5]) > 0.0
    np.testing.assert_allclose(roughness[filled], 36.0, rtol=1e-6)
    np.testing.assert_array_equal(roughness[~filled], 0.0)


def test_knots_keep_apart_and_contacts_are_multiple() -> None:
    x = np.sort(np.concatenate([np.linspace(0.0, 1.0, 40), 0.5 + 1e-6 * np.arange(1, 20)]))
    knots = knot_vector(x, 100, 5, (0.3,))
    inner = knots[6:-6]
    assert np.count_nonzero(inner == 0.3) == 4
    assert np.diff(np.unique(knots)).min() >= 0.2 / 100
