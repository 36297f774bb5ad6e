"""What every Smoother must do: subclass SmootherContract in a test module and give it one fixture."""

import numpy as np
import pytest
import xarray as xr

from crashkit.protocols import Smoother

NAMES = ("value", "first_derivative", "second_derivative")
NOISE = 1e-3  # m
DRAWS = 30


class SmootherContract:
    """The contract of a Smoother.

    Subclasses give the fixture
        smoother: an instance.

    Attributes:
        coverage: the share of samples, at the least, within two standard deviations of the truth, for each of NAMES.
        largest_error: of the truth's range, at the most, for each of NAMES, when 200 samples show it with 1 mm of noise.
    """

    coverage = (0.85, 0.85, 0.8)
    largest_error = (0.002, 0.02, 0.15)

    @pytest.mark.parametrize("unit", [1.0, 1e3, 1e6])
    def test_polynomials_of_the_declared_degree_are_reproduced(self, smoother: Smoother, unit: float) -> None:
        times = uneven_times(120)
        scaled = times / times[-1]
        polynomial = np.polynomial.Polynomial(np.linspace(1.0, 2.0, smoother.degree + 1))
        smooth = smoother.smooth(channel(times * unit, polynomial(scaled)))
        for order, name in enumerate(NAMES):
            expected = polynomial.deriv(order)(scaled)
            np.testing.assert_allclose(smooth[name] * (times[-1] * unit) ** order, expected, atol=1e-6)

    def test_it_finds_a_motion_in_noise(self, smoother: Smoother) -> None:
        times, truth = stop(np.linspace(0.0, 0.14, 200))
        errors = []
        for draw in range(DRAWS):
            smooth = smoother.smooth(channel(times, noisy(truth[0], draw)))
            errors.append([rms(smooth[name].values - exact) for name, exact in zip(NAMES, truth, strict=True)])
        relative = np.median(errors, axis=0) / [np.ptp(exact) for exact in truth]
        assert (relative <= self.largest_error).all(), relative

    def test_the_unit_of_time_does_not_matter(self, smoother: Smoother) -> None:
        times, truth = stop(uneven_times(200))
        samples = noisy(truth[0], 1)
        seconds = smoother.smooth(channel(times, samples))
        microseconds = smoother.smooth(channel(times * 1e6, samples))
        for order, name in enumerate(NAMES):
            for suffix, digits in (("", 1e-5), ("_std", 1e-3)):
                one, other = seconds[name + suffix].values, microseconds[name + suffix].values * 1e6**order
                np.testing.assert_allclose(other, one, rtol=0.0, atol=digits * np.abs(one).max())

    def test_missing_samples_are_bridged_and_less_certain(self, smoother: Smoother) -> None:
        times, truth = stop(np.linspace(0.0, 0.14, 200))
        samples = noisy(truth[0], 2)
        samples[90:105] = np.nan
        samples[-1] = np.nan
        smooth = smoother.smooth(channel(times, samples))
        np.testing.assert_array_equal(smooth["time"], times)
        assert all(np.isfinite(variable).all() for variable in smooth.data_vars.values())
        assert np.abs(smooth["value"].values - truth[0])[90:105].max() < 5 * NOISE
        assert smooth["value_std"][97] > 1.2 * smooth["value_std"][60]

    def test_bands_cover_the_truth_about_as_often_as_they_say(self, smoother: Smoother) -> None:
        times, truth = stop(np.linspace(0.0, 0.14, 200))
        covered = []
        for draw in range(DRAWS):
            smooth = smoother.smooth(channel(times, noisy(truth[0], draw)))
            covered.append([within_two(smooth, name, exact) for name, exact in zip(NAMES, truth, strict=True)])
            assert np.mean(smooth["value_std"]) < NOISE, "a band wider than the noise says nothing"
        assert (np.mean(covered, axis=0) >= self.coverage).all(), np.mean(covered, axis=0)

    def test_noise_is_estimated_or_taken_as_given(self, smoother: Smoother) -> None:
        times, truth = stop(np.linspace(0.0, 0.14, 200))
        estimates = [smoother.smooth(channel(times, noisy(truth[0], draw))).attrs["noise_std"] for draw in range(DRAWS)]
        assert np.median(estimates) == pytest.approx(NOISE, rel=0.1)
        samples = channel(times, noisy(truth[0], 0))
        given, doubled = smoother.smooth(samples, std=0.002), smoother.smooth(samples, std=0.004)
        assert given.attrs["noise_std"] == 0.002
        assert (doubled["value_std"] > given["value_std"]).all()

    def test_it_says_what_it_chose(self, smoother: Smoother) -> None:
        times, truth = stop(np.linspace(0.0, 0.14, 200))
        attrs = smoother.smooth(channel(times, noisy(truth[0], 3))).attrs
        assert attrs["smoothing_parameter"] > 0.0
        assert smoother.degree < attrs["effective_degrees_of_freedom"] < 100
        assert len(attrs["choice"].split()) > 3


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
