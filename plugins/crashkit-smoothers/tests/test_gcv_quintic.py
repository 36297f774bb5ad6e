from math import factorial

import numpy as np
import pytest
import xarray as xr
from numpy.polynomial import Polynomial

from crashkit.errors import CrashkitError
from crashkit.testing.smoother_contract import SmootherContract, channel, noisy, stop, uneven_times
from crashkit_smoothers import GcvQuintic


class TestGcvQuinticContract(SmootherContract):
    @pytest.fixture
    def smoother(self) -> GcvQuintic:
        return GcvQuintic()


class KernelSpline:
    """The quintic smoothing spline by its reproducing kernel (Wahba 1990, Spline Models, eq 2.4.21), with no knots or basis.

    f = sum d_k t^k / k! + sum c_i K(t_i, t), K(s, t) = integral of (s - u)_+^2 (t - u)_+^2 / 2!^2 du over [0, 1].
    """

    def __init__(self, x: np.ndarray) -> None:
        self.parabolas = np.stack([x**k / factorial(k) for k in range(3)], axis=1)
        self.kernel = np.array([[self._kernel(min(s, t), max(s, t)) for t in x] for s in x])

    @staticmethod
    def _kernel(near: float, far: float) -> float:
        product = Polynomial([near, -1.0]) ** 2 * Polynomial([far, -1.0]) ** 2 / 4.0
        return float(product.integ()(near) - product.integ()(0.0))

    def influence(self, smoothing: float) -> np.ndarray:
        """A of f = A z, from I - A = smoothing Q (Q'(K + smoothing I) Q)^-1 Q' with Q orthogonal to the parabolas."""
        n = len(self.kernel)
        null = np.linalg.qr(self.parabolas, mode="complete")[0][:, 3:]
        inner = null.T @ (self.kernel + smoothing * np.eye(n)) @ null
        return np.eye(n) - smoothing * null @ np.linalg.solve(inner, null.T)

    def score(self, z: np.ndarray, smoothing: float) -> float:
        rest = np.eye(len(z)) - self.influence(smoothing)
        return float(np.mean((rest @ z) ** 2) / np.mean(np.diag(rest)) ** 2)


def test_it_is_the_smoothing_spline_and_its_score_is_the_least() -> None:
    times, truth = stop(uneven_times(60))
    z = noisy(truth[0], 4)
    smooth = GcvQuintic().smooth(channel(times, z))
    smoothing = smooth.attrs["smoothing_parameter"] / times[-1] ** 5
    kernel = KernelSpline(times / times[-1])
    influence = kernel.influence(smoothing)
    np.testing.assert_allclose(smooth["value"], influence @ z, atol=1e-8)
    assert smooth.attrs["effective_degrees_of_freedom"] == pytest.approx(np.trace(influence), rel=1e-6)
    np.testing.assert_allclose(smooth["value_std"], smooth.attrs["noise_std"] * np.sqrt(np.diag(influence)), rtol=1e-5)
    least = kernel.score(z, smoothing)
    assert all(least < kernel.score(z, smoothing * factor) for factor in (1e-4, 1e-2, 0.3, 3.0, 1e2, 1e4))


def test_derivatives_belong_to_the_values() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 2001))
    smooth = GcvQuintic().smooth(channel(times, noisy(truth[0], 5)))
    velocity = np.gradient(smooth["value"].values, times, edge_order=2)
    acceleration = np.gradient(smooth["first_derivative"].values, times, edge_order=2)
    np.testing.assert_allclose(smooth["first_derivative"], velocity, atol=1e-2)
    np.testing.assert_allclose(smooth["second_derivative"], acceleration, atol=1.0)


def test_the_bands_of_derivatives_are_those_of_the_spread_over_draws() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 200))
    draws = [GcvQuintic().smooth(channel(times, noisy(truth[0], draw)), std=1e-3) for draw in range(40)]
    for name in ("first_derivative", "second_derivative"):
        spread = np.std([draw[name].values for draw in draws], axis=0)[20:-20].mean()
        claimed = np.mean([draw[f"{name}_std"].values for draw in draws], axis=0)[20:-20].mean()
        assert 0.8 < claimed / spread < 2.0


def test_many_samples_keep_their_digits() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 20_000))
    smooth = GcvQuintic().smooth(channel(times, noisy(truth[0], 6)))
    error = smooth["second_derivative"].values - truth[2]
    assert np.sqrt(np.mean(error**2)) < 4.0
    assert smooth.attrs["noise_std"] == pytest.approx(1e-3, rel=0.02)


def test_a_rough_signal_gets_the_knots_that_it_needs() -> None:
    times = np.linspace(0.0, 0.14, 1400)
    rough = np.sin(2.0 * np.pi * 800.0 * times)
    smooth = GcvQuintic().smooth(channel(times, rough + 10.0 * noisy(0.0 * times, 9)))
    assert smooth.attrs["noise_std"] == pytest.approx(0.01, rel=0.15)
    assert np.sqrt(np.mean((smooth["value"].values - rough) ** 2)) < 0.01


def test_samples_without_noise_are_followed() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 200))
    smooth = GcvQuintic().smooth(channel(times, truth[0]))
    assert np.abs(smooth["value"].values - truth[0]).max() < 1e-6
    assert np.abs(smooth["second_derivative"].values - truth[2]).max() < 3.0


def test_a_distant_origin_of_time_changes_nothing() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 200))
    samples = noisy(truth[0], 7)
    here, there = GcvQuintic().smooth(channel(times, samples)), GcvQuintic().smooth(channel(times + 1000.0, samples + 50.0))
    np.testing.assert_allclose(there["second_derivative"], here["second_derivative"], atol=1e-3)


def test_too_few_samples_are_refused() -> None:
    samples = channel(np.arange(8.0), np.array([0.0, 1.0, np.nan, 2.0, np.nan, 1.0, np.nan, 0.0]))
    with pytest.raises(CrashkitError, match="gcv_quintic: expected at least 6 samples, found 5"):
        GcvQuintic().smooth(samples)


def test_the_result_is_a_dataset_over_the_same_times() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 50))
    smooth = GcvQuintic().smooth(channel(times, noisy(truth[0], 8)))
    assert isinstance(smooth, xr.Dataset)
    assert {variable.dims for variable in smooth.data_vars.values()} == {("time",)}
