"""The spectral smoother against a dense Gaussian process, and the ends that it matches."""

import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.testing.smoother_contract import channel, noisy, rms, stop, uneven_times
from crashkit_smoothers import GcvQuintic, Spectral


class DenseProcess:
    """The same prior, sample by sample: a polynomial, sines of falling power, white noise."""

    def __init__(self, smooth: xr.Dataset, degree: int) -> None:
        self.count = smooth.sizes["time"]
        step = float(smooth["time"][1] - smooth["time"][0])
        self.length = step * self.count
        self.x = (np.arange(self.count) + 0.5) / self.count
        self.degree = degree
        self.k = np.arange(1, self.count)

    def signal(self, corner: float, decay: float) -> np.ndarray:
        """(mode,) power over that of the noise; `corner` in Hz."""
        return (2.0 * self.length * corner / self.k) ** (2.0 * decay)

    def basis(self, derivative: int) -> tuple[np.ndarray, np.ndarray]:
        """Polynomials and sines, or their derivatives by time."""
        polynomials = np.stack(
            [np.polynomial.Polynomial.basis(p).deriv(derivative)(self.x) for p in range(self.degree + 1)], axis=1
        )
        waves = np.pi * np.outer(self.x, self.k)
        sines = np.sqrt(2.0 / self.count) * np.sin(waves + 0.5 * np.pi * derivative) * (np.pi * self.k) ** derivative
        return polynomials / self.length**derivative, sines / self.length**derivative

    def posterior(self, z: np.ndarray, derivative: int, corner: float, decay: float) -> tuple[np.ndarray, np.ndarray]:
        """Mean, and standard deviation for noise 1; NaN in z where a sample is missing."""
        seen = np.isfinite(z)
        rows = np.concatenate(self.basis(0), axis=1)[seen]
        covariance = np.linalg.inv(rows.T @ rows + np.diag(self._precision(corner, decay)))
        at = np.concatenate(self.basis(derivative), axis=1)
        return at @ covariance @ rows.T @ z[seen], np.sqrt(np.sum(at @ covariance * at, axis=1))

    def deviance(self, z: np.ndarray, corner: float, decay: float) -> float:
        """-2 ln L with the noise and the polynomial at their best."""
        seen = np.isfinite(z)
        rows = np.concatenate(self.basis(0), axis=1)[seen]
        precision = self._precision(corner, decay)
        factors = np.linalg.solve(rows.T @ rows + np.diag(precision), rows.T @ z[seen])
        square = np.sum((z[seen] - rows @ factors) ** 2) + np.sum(precision * factors**2)
        sines, prior = rows[:, self.degree + 1 :], precision[self.degree + 1 :]
        size = np.linalg.slogdet(sines.T @ sines + np.diag(prior))[1] - np.sum(np.log(prior))
        return float(seen.sum() * np.log(square) + size)

    def _precision(self, corner: float, decay: float) -> np.ndarray:
        return np.concatenate([np.zeros(self.degree + 1), 1.0 / self.signal(corner, decay)])


@pytest.mark.parametrize("gap", [False, True])
def test_it_is_the_posterior_at_the_greatest_likelihood(gap: bool) -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 90))
    z = noisy(truth[0], 3)
    if gap:
        z[40:47] = np.nan
        z[0] = np.nan
    smooth = Spectral().smooth(channel(times, z))
    corner, decay = smooth.attrs["corner_frequency"], smooth.attrs["decay"]
    process = DenseProcess(smooth, 1 if "line" in smooth.attrs["ends"] else 3)
    for derivative, name in enumerate(("value", "first_derivative", "second_derivative")):
        mean, spread = process.posterior(z, derivative, corner, decay)
        np.testing.assert_allclose(smooth[name], mean, rtol=0.0, atol=1e-6 * np.abs(mean).max())
        np.testing.assert_allclose(smooth[f"{name}_std"], smooth.attrs["noise_std"] * spread, rtol=1e-5)
    least = process.deviance(z, corner, decay)
    for elsewhere in ((0.8, 1.0), (1.25, 1.0), (1.0, 0.9), (1.0, 1.1)):
        assert process.deviance(z, corner * elsewhere[0], float(np.clip(decay * elsewhere[1], 2.75, 4.5))) >= least - 1e-2


def test_the_ends_are_matched_by_what_the_motion_needs() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 200))
    assert Spectral().smooth(channel(times, noisy(truth[0], 1))).attrs["ends"] == "odd extension about a line"
    braking = 14.0 * times - 50.0 * times**2
    smooth = Spectral().smooth(channel(times, noisy(braking, 1)))
    assert smooth.attrs["ends"] == "odd extension about a cubic"
    assert rms(smooth["second_derivative"].values + 100.0) < 3.0


def test_bands_cover_where_the_record_ends_in_the_pulse() -> None:
    times, truth = stop(np.linspace(0.0, 0.07, 140))
    covered = [
        np.abs(smooth["second_derivative"].values - truth[2]) < 2.0 * smooth["second_derivative_std"].values
        for smooth in (Spectral().smooth(channel(times, noisy(truth[0], draw))) for draw in range(20))
    ]
    assert np.mean(covered) > 0.8


def test_steps_that_differ_are_refused_with_the_remedy() -> None:
    times, truth = stop(uneven_times(100))
    expected = r"spectral: expected equal steps, found 0\.000\d+ to 0\.00\d+ s: a smoothing spline takes them"
    with pytest.raises(CrashkitError, match=expected):
        Spectral().smooth(channel(times, truth[0]))


def test_too_many_missing_samples_are_refused() -> None:
    samples = np.where(np.arange(400) % 2, np.nan, 0.0)
    with pytest.raises(CrashkitError, match="spectral: expected at most 100 missing samples, found 200"):
        Spectral().smooth(channel(np.arange(400.0), samples))


def test_a_fast_motion_gets_the_modes_that_it_needs() -> None:
    times = np.linspace(0.0, 1.0, 20_000)
    fast = np.sin(2.0 * np.pi * 700.0 * times)
    smooth = Spectral().smooth(channel(times, fast + 100.0 * noisy(0.0 * times, 2)))
    assert rms(smooth["value"].values - fast) < 0.05
    assert smooth.attrs["noise_std"] == pytest.approx(0.1, rel=0.05)


def test_many_samples() -> None:
    times, truth = stop(np.linspace(0.0, 0.14, 100_000))
    smooth = Spectral().smooth(channel(times, noisy(truth[0], 6)))
    quintic = GcvQuintic().smooth(channel(times, noisy(truth[0], 6)))
    assert rms(smooth["second_derivative"].values - truth[2]) < 2.0
    np.testing.assert_allclose(smooth["value"], quintic["value"], atol=2e-4)
