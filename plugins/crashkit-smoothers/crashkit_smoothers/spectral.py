"""Regularised spectral differentiation: equal samples, their ends matched, the filter by maximum likelihood."""

import math
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.data.channel_filter import DESIGN_FREQUENCY
from crashkit.errors import CrashkitError
from crashkit.protocols import Smoother
from crashkit_smoothers.curve import curve
from crashkit_smoothers.reading import Reading, read_channel
from crashkit_smoothers.sine_series import amplitudes, derivative, variance
from crashkit_smoothers.spectral_model import Estimate, SpectralModel

FEWEST = 10
EVEN = 0.01
"""Of a step, by which steps may differ."""
MOST_MISSING = 100
MOST_MODES = 2000
"""Modes of the series at first; there are more where the motion needs them."""
ROOM = 0.2
"""Of the modes, up to which the corner may lie."""
PASSED = 0.05
"""Power that the filter of a channel passes, at the least, in the modes that are looked at."""
ENDS = {1: "odd extension about a line", 3: "odd extension about a cubic"}
"""By degree of the polynomial, which takes up value and, if a cubic, second derivative at both ends."""


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
        gain = _gain(reading, samples)
        fits = [_fit(reading, gain, degree) for degree in ENDS]
        best = min(fits, key=lambda fit: fit.estimate.deviance)
        values, spreads = best.evaluated()
        return curve(reading, values, spreads, best.attrs())


@frozen
class _SpectralFit:
    """What the samples' likelihood makes of them, with ends matched by a polynomial of that degree."""

    reading: Reading
    gain: np.ndarray
    degree: int
    estimate: Estimate
    found: float

    def evaluated(self) -> tuple[np.ndarray, np.ndarray]:
        """Value, first and second derivative at all instants, and their standard deviations: both (3, time)."""
        count, estimate = len(self.reading.x), self.estimate
        modes = len(estimate.amplitudes)
        gain = self.gain[:modes]
        signal = 1.0 - estimate.law.noise_share(modes)
        taken = (signal * gain)[:, None] * (amplitudes(_columns(self.reading, self.degree))[:modes] / gain[:, None])
        values, spreads = np.empty((3, count)), np.empty((3, count))
        for order in range(3):
            columns = _columns(self.reading, self.degree, order)
            columns[:, self.degree + 1 :] = 0.0
            values[order] = columns @ estimate.factors + derivative(gain * estimate.amplitudes, count, order)
            columns -= derivative(taken, count, order)
            power = variance(signal * gain**2, count, order) + np.sum(columns @ estimate.covariance * columns, axis=1)
            spreads[order] = self._noise * np.sqrt(np.maximum(power, 0.0))
        by_reading = ((count - 1) / count) ** np.arange(3)[:, None]
        return values * by_reading, spreads * by_reading

    @property
    def _noise(self) -> float:
        """Of a mode before the filter."""
        return self.found if self.reading.std is None else self.reading.std * math.sqrt(self.reading.correlation)

    def attrs(self) -> dict[str, object]:
        """What was chosen and why."""
        law, reading = self.estimate.law, self.reading
        length = reading.duration * len(reading.x) / (len(reading.x) - 1)
        corner = law.corner / (2.0 * length)
        words = "the likelihood" if reading.std is None else "the likelihood with the given noise"
        return {
            "noise_std": self._noise / math.sqrt(reading.correlation),
            "smoothing_parameter": (2.0 * np.pi * corner) ** (-2.0 * law.decay),
            "effective_degrees_of_freedom": self.estimate.freedom,
            "corner_frequency": corner,
            "decay": law.decay,
            "ends": ENDS[self.degree],
            "choice": f"{words} chose a low pass of {corner:.3g} Hz, {self.estimate.freedom:.1f} degrees of freedom "
            f"for {len(reading.z)} samples, and the {ENDS[self.degree]}",
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


def _gain(reading: Reading, samples: xr.DataArray) -> np.ndarray:
    """(mode,) what the filter that the samples declare lets pass, for those modes of which it lets pass enough."""
    count = len(reading.x)
    filter_class = float(samples.attrs.get("channel_frequency_class", 0))
    if not filter_class:
        return np.ones(count)
    interval = reading.duration / (count - 1)
    warped = np.tan(0.5 * np.pi * np.arange(1, count) / count) / math.tan(math.pi * DESIGN_FREQUENCY * filter_class * interval)
    gain = 1.0 / (1.0 + warped**4)
    return gain[gain**2 > PASSED]


def _columns(reading: Reading, degree: int, order: int = 0) -> np.ndarray:
    """(sample, column) what has no prior, or its derivative by x: Legendre's polynomials, then a 1 at each missing sample."""
    count = len(reading.x)
    u = (2.0 * np.arange(count) + 1.0) / count - 1.0
    powers = [np.polynomial.Legendre.basis(k).deriv(order)(u) * 2.0**order for k in range(degree + 1)]
    gaps = np.zeros((count, count - len(reading.z)))
    if order == 0:
        gaps[~reading.present, np.arange(gaps.shape[1])] = 1.0
    return np.concatenate([np.stack(powers, axis=1), gaps], axis=1)


def _fit(reading: Reading, gain: np.ndarray, degree: int) -> _SpectralFit:
    """The best law, of as many modes as it needs."""
    samples = np.zeros(len(reading.x))
    samples[reading.present] = reading.z
    data = amplitudes(samples)[: len(gain)] / gain
    columns = amplitudes(_columns(reading, degree))[: len(gain)] / gain[:, None]
    variance = None if reading.std is None else reading.std**2 * reading.correlation
    rounding = reading.rounding / reading.scale[0] ** 2
    most = min(len(gain), len(samples) - 1)
    modes = min(MOST_MODES, most)
    while True:
        model = SpectralModel.of(data, columns, modes, len(samples) - len(reading.z), variance, rounding)
        estimate = model.best()
        if modes == most or estimate.law.corner < ROOM * modes:
            found = math.sqrt(estimate.square / (model.count - degree - 1))
            return _SpectralFit(reading, gain, degree, estimate, found)
        modes = min(4 * modes, most)
