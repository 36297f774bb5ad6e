from math import factorial

import numpy as np
import pytest
import xarray as xr
from numpy.polynomial import Polynomial

from crashkit.protocols import Smoother
from crashkit.testing.smoother_contract import NAMES, channel, noisy, rms, stop, uneven_times
from crashkit_smoothers import AdaptiveQuintic, GcvCubic, GcvHeptic, GcvQuintic

GCV = {2: GcvCubic(), 3: GcvQuintic(), 4: GcvHeptic()}
EVERY = [*GCV.values(), AdaptiveQuintic()]


class KernelSpline:
    """The smoothing spline by its reproducing kernel (Wahba 1990, Spline Models, eq 2.4.21), with no knots or basis.

    f = sum d_k t^k / k! + sum c_i K(t_i, t), K(s, t) = integral of (s - u)_+^(q-1) (t - u)_+^(q-1) / (q-1)!^2 du over [0, 1].
    """

    def __init__(self, x: np.ndarray, order: int) -> None:
        self.order = order
        self.polynomials = np.stack([x**k / factorial(k) for k in range(order)], axis=1)
        self.kernel = np.array([[self._kernel(min(s, t), max(s, t)) for t in x] for s in x])

    def _kernel(self, near: float, far: float) -> float:
        power = self.order - 1
        product = Polynomial([near, -1.0]) ** power * Polynomial([far, -1.0]) ** power / factorial(power) ** 2
        return float(product.integ()(near) - product.integ()(0.0))

    def influence(self, smoothing: float, variance: np.ndarray) -> np.ndarray:
        """A of f = A z, I - A = smoothing W Q (Q'(K + smoothing W) Q)^-1 Q', Q orthogonal to the polynomials, W variances."""
        null = np.linalg.qr(self.polynomials, mode="complete")[0][:, self.order :]
        inner = null.T @ (self.kernel + smoothing * np.diag(variance)) @ null
        return np.eye(len(variance)) - smoothing * np.diag(variance) @ null @ np.linalg.solve(inner, null.T)


@pytest.mark.parametrize("order", GCV)
def test_it_is_the_smoothing_spline_and_its_score_is_the_least(order: int) -> None:
    times, truth = stop(uneven_times(60))
    z = noisy(truth[0], 4)
    smooth = GCV[order].smooth(channel(times, z))
    smoothing = smooth.attrs["smoothing_parameter"] / times[-1] ** (2 * order - 1)
    kernel = KernelSpline(times / times[-1], order)
    influence = kernel.influence(smoothing, np.ones(60))
    np.testing.assert_allclose(smooth["value"], influence @ z, atol=1e-6)
    assert smooth.attrs["effective_degrees_of_freedom"] == pytest.approx(np.trace(influence), rel=1e-4)
    np.testing.assert_allclose(smooth["value_std"], smooth.attrs["noise_std"] * np.sqrt(np.diag(influence)), rtol=1e-3)

    def score(times_as_much: float) -> float:
        rest = np.eye(60) - kernel.influence(smoothing * times_as_much, np.ones(60))
        return float(np.mean((rest @ z) ** 2) / np.mean(np.diag(rest)) ** 2)

    assert all(score(1.0) < score(factor) for factor in (1e-4, 1e-2, 0.3, 3.0, 1e2, 1e4))


def test_given_standard_deviations_weigh_the_samples_and_the_risk_is_the_least() -> None:
    times, truth = stop(uneven_times(60))
    std = np.where(np.arange(60) % 3 == 0, 4e-3, 1e-3)
    z = truth[0] + std * np.random.default_rng(5).normal(size=60)
    smooth = GcvQuintic().smooth(channel(times, z), xr.DataArray(std, {"time": times}, ("time",)))
    smoothing = smooth.attrs["smoothing_parameter"] / times[-1] ** 5
    kernel = KernelSpline(times / times[-1], 3)
    variance = (std / np.median(std)) ** 2
    influence = kernel.influence(smoothing, variance)
    np.testing.assert_allclose(smooth["value"], influence @ z, atol=1e-8)
    np.testing.assert_allclose(smooth["value_std"], np.sqrt(np.diag(influence @ np.diag(std**2))), rtol=1e-4)

    def risk(times_as_much: float) -> float:
        influence = kernel.influence(smoothing * times_as_much, variance)
        return float(np.sum(((z - influence @ z) / std) ** 2) + 2.0 * np.trace(influence))

    assert all(risk(1.0) < risk(factor) for factor in (1e-3, 0.3, 3.0, 1e3))


@pytest.mark.parametrize("smoother", EVERY, ids=lambda smoother: smoother.name)
def test_derivatives_belong_to_the_values(smoother: Smoother) -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 2001))
    smooth = smoother.smooth(channel(times, noisy(truth[0], 5)))
    velocity = np.gradient(smooth["value"].values, times, edge_order=2)
    acceleration = np.gradient(smooth["first_derivative"].values, times, edge_order=2)
    np.testing.assert_allclose(smooth["first_derivative"], velocity, atol=1e-2)
    np.testing.assert_allclose(smooth["second_derivative"][1:-1], acceleration[1:-1], atol=1.0)


@pytest.mark.parametrize("smoother", EVERY[1:], ids=lambda smoother: smoother.name)
def test_many_samples_keep_their_digits(smoother: Smoother) -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 100_000))
    smooth = smoother.smooth(channel(times, noisy(truth[0], 6)))
    assert rms(smooth["second_derivative"].values - truth[2]) < 2.0
    assert smooth.attrs["noise_std"] == pytest.approx(1e-3, rel=0.01)
    assert np.mean(np.abs(smooth["value"] - truth[0]) < 2.0 * smooth["value_std"]) > 0.85


@pytest.mark.parametrize("smoother", EVERY[1:], ids=lambda smoother: smoother.name)
def test_a_rough_signal_gets_the_knots_that_it_needs(smoother: Smoother) -> None:
    times = np.linspace(0.0, 0.14, 1400)
    rough = np.sin(2.0 * np.pi * 800.0 * times)
    smooth = smoother.smooth(channel(times, rough + 10.0 * noisy(0.0 * times, 9)))
    assert smooth.attrs["noise_std"] == pytest.approx(0.01, rel=0.15)
    assert rms(smooth["value"].values - rough) < 0.01


@pytest.mark.parametrize("smoother", EVERY, ids=lambda smoother: smoother.name)
def test_samples_without_noise_are_followed(smoother: Smoother) -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 200))
    smooth = smoother.smooth(channel(times, truth[0]))
    assert np.abs(smooth["value"].values - truth[0]).max() < 1e-6
    assert np.abs(smooth["second_derivative"].values - truth[2]).max() < 3.0


def test_the_adaptive_spline_is_nearer_to_the_acceleration_than_cross_validation_and_never_far_off() -> None:
    times, truth = stop(np.arange(200) * 1e-3)
    draws = [channel(times, noisy(truth[0], draw)) for draw in range(40)]
    adaptive, plain = (
        [rms(smoother.smooth(draw)["second_derivative"].values - truth[2]) for draw in draws]
        for smoother in (AdaptiveQuintic(), GcvQuintic())
    )
    assert np.median(adaptive) < 0.8 * np.median(plain)
    assert max(adaptive) < 0.7 * max(plain)


def test_derivatives_carry_units() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 50))
    smooth = GcvQuintic().smooth(channel(times, noisy(truth[0], 8)).assign_attrs(units="m"))
    assert [smooth[name].attrs["units"] for name in NAMES] == ["m", "m s-1", "m s-2"]
    assert smooth["second_derivative_std"].attrs["units"] == "m s-2"
    force = GcvQuintic().smooth(channel(times, truth[0]).assign_attrs(units="N"))
    assert force["first_derivative"].attrs["units"] == "N s-1"


@pytest.mark.parametrize("smoother", EVERY, ids=lambda smoother: smoother.name)
def test_as_few_samples_as_there_may_be(smoother: Smoother) -> None:
    times = np.linspace(0.0, 0.01, 8)
    smooth = smoother.smooth(channel(times, noisy(3.0 * times, 1)))
    assert all(np.isfinite(variable).all() for variable in smooth.data_vars.values())
    assert rms(smooth["value"].values - 3.0 * times) < 2e-3
