"""The banded kernels against dense matrices on scipy's B-splines."""

import numpy as np
import pytest
from attrs import evolve
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
    """Rows whose squares sum to the integral of stiffness times the penalised derivative squared: ten Gauss points each."""
    degree = 2 * spline.order - 1
    edges = spline.knots[degree : len(spline.knots) - degree]
    points, weights = np.polynomial.legendre.leggauss(10)
    half = 0.5 * np.diff(edges)[:, None]
    x = (edges[:-1, None] + half * (1.0 + points)).ravel()
    factors = (half * weights * spline.stiffness[:, None]).ravel()
    keep = factors > 0.0
    return np.sqrt(factors[keep, None]) * dense(spline, x[keep], spline.order)


@given(
    order=st.sampled_from([2, 3, 4]),
    seed=st.integers(0, 1000),
    interior=st.integers(1, 12),
    contacts=st.sampled_from([(), (0.45,), (0.3, 0.62)]),
    logarithm=st.floats(-8.0, -2.0),
)
@settings(max_examples=40, deadline=None)
def test_fits_agree_with_dense_least_squares(
    order: int, seed: int, interior: int, contacts: tuple[float, ...], logarithm: float
) -> None:
    rng = np.random.default_rng(seed)
    x = np.sort(np.concatenate([[0.0, 1.0], rng.uniform(size=600 if seed % 2 else 60)]))
    z, scale = np.sin(6.0 * x) + rng.normal(scale=0.1, size=len(x)), rng.uniform(0.5, 2.0, len(x))
    spline = PenalisedSpline.of(x, z, scale, knot_vector(x, interior, 2 * order - 1, contacts), order)
    spline = evolve(spline, stiffness=rng.uniform(0.2, 5.0, len(spline.stiffness)))
    fit = spline.with_smoothing(10.0**logarithm)

    rows = scale[:, None] * dense(spline, x)
    stacked = np.concatenate([rows, 10.0 ** (0.5 * logarithm) * dense_roughness(spline)])
    root = np.linalg.inv(np.linalg.qr(stacked)[1])  # of the covariance: normal equations would be less exact than ours
    coefficients = root @ (root.T @ rows.T @ (scale * z))
    assert fit.freedom == pytest.approx(np.sum((rows @ root) ** 2), rel=1e-4)
    assert fit.residual == pytest.approx(np.sum((scale * z - rows @ coefficients) ** 2), rel=1e-5)
    values, spreads = spline.evaluated(x, fit)
    for derivative in range(3):
        basis = dense(spline, x, derivative)
        expected = basis @ coefficients
        np.testing.assert_allclose(values[derivative], expected, rtol=0.0, atol=1e-4 * np.abs(expected).max())
        np.testing.assert_allclose(spreads[derivative], np.linalg.norm(basis @ root, axis=1), rtol=1e-3)


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
