"""Regularised spectral differentiation: equal samples, their ends matched, the filter by maximum likelihood."""

import math
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.data.channel_filter import frequency_class
from crashkit.errors import CrashkitError
from crashkit.protocols import Smoother
from crashkit_smoothers.curve import curve
from crashkit_smoothers.noise_level import FULL, doubt, exceeds
from crashkit_smoothers.reading import Reading, read_channel
from crashkit_smoothers.spectral_fit import ENDS, SpectralFit, fit_spectrum

FEWEST = 10
EVEN = 0.01
"""Of a step, by which steps may differ."""
MOST_MISSING = 100


@frozen
class Spectral(Smoother):
    """A polynomial and a sine series, whose amplitudes are filtered by 1 / (1 + (k / corner)^(2 decay)).

    As the posterior mean where the power of the series falls like k^(-2 decay) below white noise this is Tikhonov's
    regularisation in Anderssen and Bloomfield's stationary form. Corner and decay are those of the greatest likelihood.

    A sine series is the odd extension about both ends: right where value and second derivative vanish there. The polynomial
    takes these up, and its degree, 1 or 3, is again a matter of likelihood.

    Takes samples at equal steps, all of the same standard deviation, a hundred of them missing at the most.

    Mizzi & Jezequel 1992, eq 29-30; Anderssen & Bloomfield 1974, doi:10.1007/BF01436965.
    """

    name: ClassVar[str] = "spectral"
    degree: ClassVar[int] = 3
    equal_samples: ClassVar[bool] = True

    def smooth(self, samples: xr.DataArray, std: float | xr.DataArray | None = None) -> xr.Dataset:
        """Smooth one channel, as `Smoother.smooth` says.

        The filter's gain is 1 / (1 + p (2 pi f)^(2 m)): `smoothing_parameter` is p in s^(2 m), `decay` is m, and
        `corner_frequency`, Hz, is where the gain is a half.

        Raises CrashkitError where steps or standard deviations differ, and where too many samples are missing.
        """
        reading = read_channel(self.name, samples, std, FEWEST)
        _require_equal_samples(reading)
        fit, level = _believed(reading, frequency_class(samples))
        values, spreads = fit.evaluated()
        spreads *= level
        return curve(reading, values, spreads, _attrs(reading, fit, level))


def _believed(reading: Reading, filter_class: float) -> tuple[SpectralFit, float]:
    """The fit, and the noise before the filter: as given unless the samples show that there is more."""
    if reading.std is None:
        fit = fit_spectrum(reading, filter_class, known=False)
        return fit, fit.found
    given = reading.std * math.sqrt(reading.correlation)
    fit = fit_spectrum(reading, filter_class, known=True)
    if fit.estimate.freedom < FULL * reading.count and not exceeds(fit.found, given, fit.left):
        return fit, given
    unknown = fit_spectrum(reading, filter_class, known=False)
    return (unknown, unknown.found) if exceeds(unknown.found, given, unknown.left) else (fit, given)


def _attrs(reading: Reading, fit: SpectralFit, level: float) -> dict[str, object]:
    corner, decay, freedom = fit.corner_frequency, fit.estimate.law.decay, fit.estimate.freedom
    sentence = (
        f"the likelihood chose a low pass of {corner:.3g} Hz, {freedom:.1f} degrees of freedom for {len(reading.z)} samples, "
        f"and the {ENDS[fit.degree]}"
    )
    if reading.std is not None:
        given = reading.std * math.sqrt(reading.correlation)
        sentence += doubt(level / given, fit.found / given, fit.left)
    return {
        "noise_std": level / math.sqrt(reading.correlation),
        "smoothing_parameter": (2.0 * np.pi * corner) ** (-2.0 * decay),
        "effective_degrees_of_freedom": freedom,
        "corner_frequency": corner,
        "decay": decay,
        "ends": ENDS[fit.degree],
        "choice": sentence,
    }


def _require_equal_samples(reading: Reading) -> None:
    steps = np.diff(reading.x)
    missing = len(reading.x) - len(reading.z)
    faults = []
    if np.ptp(steps) > EVEN * steps.mean():
        shortest, longest = steps.min() * reading.duration, steps.max() * reading.duration
        faults.append(f"equal steps, found {shortest:.4g} to {longest:.4g} s")
    if np.ptp(reading.scale) > 0.0:
        faults.append("one standard deviation for all samples, found several")
    if missing > MOST_MISSING:
        faults.append(f"at most {MOST_MISSING} missing samples, found {missing}")
    if faults:
        raise CrashkitError("\n".join(f"spectral: expected {fault}: a smoothing spline takes them" for fault in faults))
