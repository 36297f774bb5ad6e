"""What every Smoother must do: subclass SmootherContract in a test module and give it one fixture."""

from functools import lru_cache

import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.protocols import Smoother

NAMES = ("value", "first_derivative", "second_derivative")
NOISE = 1e-3  # m
DRAWS = 40
COUNT = 200


class SmootherContract:
    """The contract of a Smoother.

    Subclasses give the fixture
        smoother: an instance.

    Attributes:
        coverage: the share of samples, at the least, within two standard deviations of the truth, for each of NAMES.
        widest: claimed standard deviation over the error's root mean square, at the most, for each of NAMES.
        largest_error: of the truth's range, at the most, for each of NAMES, when 200 samples show it with 1 mm of noise.
    """

    coverage = (0.92, 0.92, 0.92)
    widest = (1.15, 1.3, 1.8)
    largest_error = (0.002, 0.02, 0.1)

    @pytest.mark.parametrize("unit", [1.0, 1e3, 1e6])
    def test_polynomials_of_the_declared_degree_are_reproduced(self, smoother: Smoother, unit: float) -> None:
        times = sampling(smoother)
        scaled = times / times[-1]
        polynomial = np.polynomial.Polynomial(np.linspace(1.0, 2.0, smoother.degree + 1))
        smooth = smoother.smooth(channel(times * unit, polynomial(scaled)))
        for order, name in enumerate(NAMES):
            expected = polynomial.deriv(order)(scaled)
            np.testing.assert_allclose(smooth[name] * (times[-1] * unit) ** order, expected, atol=1e-6)

    def test_it_finds_a_motion_in_noise(self, smoother: Smoother, draws: list[xr.Dataset]) -> None:
        _, truth = stop(sampling(smoother))
        errors = [[rms(smooth[name].values - exact) for name, exact in zip(NAMES, truth, strict=True)] for smooth in draws]
        relative = np.median(errors, axis=0) / [np.ptp(exact) for exact in truth]
        assert (relative <= self.largest_error).all(), relative

    def test_bands_cover_the_truth_as_often_as_they_say(self, smoother: Smoother, draws: list[xr.Dataset]) -> None:
        _, truth = stop(sampling(smoother))
        covered = [[within_two(smooth, name, exact) for name, exact in zip(NAMES, truth, strict=True)] for smooth in draws]
        assert (np.mean(covered, axis=0) >= self.coverage).all(), np.mean(covered, axis=0)

    def test_bands_are_no_wider_than_the_errors(self, smoother: Smoother, draws: list[xr.Dataset]) -> None:
        _, truth = stop(sampling(smoother))
        errors = [[rms(smooth[name].values - exact) for name, exact in zip(NAMES, truth, strict=True)] for smooth in draws]
        claimed = [[rms(smooth[f"{name}_std"].values) for name in NAMES] for smooth in draws]
        ratio = np.median(claimed, axis=0) / np.median(errors, axis=0)
        assert (ratio <= self.widest).all(), ratio

    @pytest.mark.parametrize("unit", [1e3, 1e6, 1e-3])
    def test_the_unit_and_the_origin_of_time_do_not_matter(self, smoother: Smoother, unit: float) -> None:
        times, truth = stop(sampling(smoother))
        samples = noisy(truth[0], 1)
        one, other = smoother.smooth(channel(times, samples)), smoother.smooth(channel((times - 7.0) * unit, samples))
        for order, name in enumerate(NAMES):
            for suffix, digits in (("", 1e-4), ("_std", 1e-3)):
                expected, found = one[name + suffix].values, other[name + suffix].values * unit**order
                np.testing.assert_allclose(found, expected, rtol=0.0, atol=digits * np.abs(expected).max())

    def test_missing_samples_are_bridged_and_less_certain(self, smoother: Smoother) -> None:
        times, truth = stop(np.linspace(0.0, 0.14, COUNT))
        samples = noisy(truth[0], 2)
        samples[90:105] = np.nan
        samples[-1] = np.nan
        smooth = smoother.smooth(channel(times, samples))
        np.testing.assert_array_equal(smooth["time"], times)
        assert all(np.isfinite(variable).all() for variable in smooth.data_vars.values())
        assert np.abs(smooth["value"].values - truth[0])[90:105].max() < 5 * NOISE
        assert smooth["value_std"][97] > 1.2 * smooth["value_std"][60]
        assert smooth["value_std"][-1] > smooth["value_std"][-5]

    def test_noise_is_estimated_or_taken_as_given(self, smoother: Smoother, draws: list[xr.Dataset]) -> None:
        assert np.median([smooth.attrs["noise_std"] for smooth in draws]) == pytest.approx(NOISE, rel=0.05)
        times, truth = stop(sampling(smoother))
        samples = channel(times, noisy(truth[0], 0))
        given, doubled = smoother.smooth(samples, std=0.002), smoother.smooth(samples, std=0.004)
        assert given.attrs["noise_std"] == 0.002
        assert (doubled["value_std"] > given["value_std"]).all()
        assert doubled.attrs["effective_degrees_of_freedom"] < given.attrs["effective_degrees_of_freedom"]

    def test_a_standard_deviation_for_each_sample_is_its_weight(self, smoother: Smoother) -> None:
        times, truth = stop(sampling(smoother))
        samples = channel(times, noisy(truth[0], 3))
        std = xr.full_like(samples, NOISE)
        xr.testing.assert_allclose(smoother.smooth(samples, std), smoother.smooth(samples, NOISE))
        std[40:44] = samples[40:44] = 1.0
        if smoother.equal_samples:
            with pytest.raises(CrashkitError, match="expected one standard deviation for all samples"):
                smoother.smooth(samples, std)
            return
        smooth, without = smoother.smooth(samples, std), smoother.smooth(samples.where(std < 1.0), NOISE)
        for name in NAMES:
            band = float(without[f"{name}_std"].max())
            np.testing.assert_allclose(smooth[name], without[name], rtol=0.0, atol=0.1 * band)

    def test_unequal_steps_are_taken_or_refused(self, smoother: Smoother) -> None:
        times, truth = stop(uneven_times(COUNT))
        samples = channel(times, noisy(truth[0], 4))
        if smoother.equal_samples:
            with pytest.raises(CrashkitError, match="expected equal steps, found"):
                smoother.smooth(samples)
        else:
            assert rms(smoother.smooth(samples)["value"].values - truth[0]) < 0.5 * NOISE

    def test_too_few_samples_are_refused(self, smoother: Smoother) -> None:
        with pytest.raises(CrashkitError, match=f"{smoother.name}: expected at least .* samples, found 2"):
            smoother.smooth(channel(np.arange(4.0), np.array([0.0, np.nan, np.nan, 1.0])))

    def test_a_channel_at_rest_is_at_rest(self, smoother: Smoother) -> None:
        smooth = smoother.smooth(channel(np.linspace(0.0, 0.14, COUNT), np.zeros(COUNT)))
        assert all(np.abs(variable).max() < 1e-9 for variable in smooth.data_vars.values())

    def test_the_samples_are_left_as_they_are(self, smoother: Smoother) -> None:
        times, truth = stop(sampling(smoother))
        samples = channel(times, noisy(truth[0], 5))
        before = samples.copy(deep=True)
        smoother.smooth(samples)
        xr.testing.assert_identical(samples, before)

    def test_it_says_what_it_chose(self, smoother: Smoother, draws: list[xr.Dataset]) -> None:
        attrs = draws[3].attrs
        assert attrs["smoothing_parameter"] > 0.0
        assert smoother.degree < attrs["effective_degrees_of_freedom"] < 100
        assert len(attrs["choice"].split()) > 3

    @pytest.fixture
    def draws(self, smoother: Smoother) -> list[xr.Dataset]:
        """The same motion with the noise of many draws, smoothed."""
        return _draws(smoother)


@lru_cache(maxsize=1)
def _draws(smoother: Smoother) -> list[xr.Dataset]:
    times, truth = stop(sampling(smoother))
    return [smoother.smooth(channel(times, noisy(truth[0], draw))) for draw in range(DRAWS)]


def sampling(smoother: Smoother) -> np.ndarray:
    """Instants as the smoother takes them: unequal steps if it can."""
    return np.linspace(0.0, 0.14, COUNT) if smoother.equal_samples else uneven_times(COUNT)


def channel(times: np.ndarray, samples: np.ndarray) -> xr.DataArray:
    """Samples as a smoother takes them."""
    return xr.DataArray(samples, {"time": times}, ("time",))


def stop(times: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """A stop from 14 m/s, x'' = -A sin^2(pi (t - 0.02) / 0.1) from 0.02 to 0.12 s: times; position, velocity, acceleration."""
    start, duration, speed = 0.02, 0.1, 14.0
    s = np.clip(times - start, 0.0, duration)
    w, half = 2.0 * np.pi / duration, speed / duration
    position = speed * np.minimum(times, start) + speed * s - half * (s**2 / 2.0 + (np.cos(w * s) - 1.0) / w**2)
    velocity = speed - half * (s - np.sin(w * s) / w)
    return times, (position, velocity, -half * (1.0 - np.cos(w * s)))


def noisy(exact: np.ndarray, draw: int) -> np.ndarray:
    """The samples with 1 mm of white noise."""
    return exact + np.random.default_rng(draw).normal(scale=NOISE, size=exact.shape)


def uneven_times(count: int) -> np.ndarray:
    """From 0 to 0.14 s in steps between 0.2 and 1.8 times the mean."""
    times = np.cumsum(np.random.default_rng(0).uniform(0.2, 1.8, count))
    return (times - times[0]) / (times[-1] - times[0]) * 0.14


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def within_two(smooth: xr.Dataset, name: str, exact: np.ndarray) -> float:
    """The share of samples whose band of two standard deviations holds the truth."""
    return float(np.mean(np.abs(smooth[name].values - exact) < 2.0 * smooth[f"{name}_std"].values))
