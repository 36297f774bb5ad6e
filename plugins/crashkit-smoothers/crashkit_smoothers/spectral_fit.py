"""The spectral model of a channel: its filter's gain, the ends that a polynomial matches, the curve and its bands."""

import math

import numpy as np
from attrs import frozen

from crashkit.data.channel_filter import DESIGN_FREQUENCY
from crashkit_smoothers.reading import Reading
from crashkit_smoothers.sine_series import amplitudes, derivative, variance
from crashkit_smoothers.spectral_model import Estimate, SpectralModel

ENDS = {1: "odd extension about a line", 3: "odd extension about a cubic"}
"""By degree of the polynomial, which takes up value and, if a cubic, second derivative at both ends."""
MOST_MODES = 2000
"""Modes of the series at first; there are more where the motion needs them."""
ROOM = 0.2
"""Of the modes, up to which the corner may lie."""
PASSED = 0.05
"""Power that the filter of a channel passes, at the least, in the modes that are looked at."""


@frozen
class SpectralFit:
    """What the likelihood makes of a channel whose ends are matched by a polynomial of that degree.

    Attributes:
        gain: (mode,) what the channel's filter lets pass, for those modes of which it lets pass enough.
        found: standard deviation of the noise before the filter, as the samples show it.
        left: degrees of freedom that show it.
    """

    reading: Reading
    gain: np.ndarray
    degree: int
    estimate: Estimate
    found: float
    left: float

    @property
    def corner_frequency(self) -> float:
        """Where signal and noise are equal, in waves to the unit of time."""
        count = len(self.reading.x)
        return 0.5 * self.estimate.law.corner * (count - 1) / (count * self.reading.duration)

    def evaluated(self) -> tuple[np.ndarray, np.ndarray]:
        """Value, first and second derivative at all instants, and their standard deviations for noise 1: both (3, time)."""
        count, estimate = len(self.reading.x), self.estimate
        modes = len(estimate.amplitudes)
        gain = self.gain[:modes]
        signal = 1.0 - estimate.law.noise_share(modes)
        taken = signal[:, None] * amplitudes(columns(self.reading, self.degree))[:modes]
        values, spreads = np.empty((3, count)), np.empty((3, count))
        for order in range(3):
            free = columns(self.reading, self.degree, order)
            free[:, self.degree + 1 :] = 0.0
            values[order] = free @ estimate.factors + derivative(gain * estimate.amplitudes, count, order)
            free -= derivative(taken, count, order)
            power = variance(signal * gain**2, count, order) + np.sum(free @ estimate.covariance * free, axis=1)
            spreads[order] = np.sqrt(np.maximum(power, 0.0))
        by_reading = ((count - 1) / count) ** np.arange(3)[:, None]
        return values * by_reading, spreads * by_reading


def fit_spectrum(reading: Reading, filter_class: float, known: bool) -> SpectralFit:
    """The law and the ends of the greatest likelihood.

    Arguments:
        filter_class: CFC of the channel, 0 if it is not filtered.
        known: whether the noise is the reading's standard deviation.
    """
    gain = _gain(reading, filter_class)
    variance = reading.std**2 * reading.correlation if known and reading.std else None
    return min((_fit(reading, gain, degree, variance) for degree in ENDS), key=lambda fit: fit.estimate.deviance)


def columns(reading: Reading, degree: int, order: int = 0) -> np.ndarray:
    """(sample, column) what has no prior, or its derivative by x: Legendre's polynomials, then a 1 at each missing sample."""
    count = len(reading.x)
    u = (2.0 * np.arange(count) + 1.0) / count - 1.0
    powers = [np.polynomial.Legendre.basis(k).deriv(order)(u) * 2.0**order for k in range(degree + 1)]
    gaps = np.zeros((count, count - len(reading.z)))
    if order == 0:
        gaps[~reading.present, np.arange(gaps.shape[1])] = 1.0
    return np.concatenate([np.stack(powers, axis=1), gaps], axis=1)


def _gain(reading: Reading, filter_class: float) -> np.ndarray:
    count = len(reading.x)
    if not filter_class:
        return np.ones(count)
    interval = reading.duration / (count - 1)
    warped = np.tan(0.5 * np.pi * np.arange(1, count) / count) / math.tan(math.pi * DESIGN_FREQUENCY * filter_class * interval)
    gain = 1.0 / (1.0 + warped**4)
    return gain[gain**2 > PASSED]


def _fit(reading: Reading, gain: np.ndarray, degree: int, variance: float | None) -> SpectralFit:
    """The best law for a polynomial of that degree, of as many modes as it needs."""
    samples = np.zeros(len(reading.x))
    samples[reading.present] = reading.z
    data = amplitudes(samples)[: len(gain)] / gain
    free = amplitudes(columns(reading, degree))[: len(gain)] / gain[:, None]
    rounding = reading.rounding / reading.scale[0] ** 2
    most = min(len(gain), len(samples) - 1)
    modes = min(MOST_MODES, most)
    while True:
        model = SpectralModel.of(data, free, modes, len(samples) - len(reading.z), variance, rounding)
        estimate = model.best()
        if modes == most or estimate.law.corner < ROOM * modes:
            left = model.count - degree - 1
            return SpectralFit(reading, gain, degree, estimate, math.sqrt(estimate.square / left), left)
        modes = min(4 * modes, most)
