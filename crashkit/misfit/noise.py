"""The noise of a recorded channel: its standard deviation, and how many samples make one independent one."""

import numpy as np
import xarray as xr
from attrs import evolve, frozen
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal import periodogram

from crashkit.data.channel_filter import CORNER, correlation_samples, frequency_class

HALF = 0.5
"""Of an estimate, which may be too large by as much."""
FEWEST = 4
"""Fourth differences from which a level is estimated."""
LOUDER = 1.1
"""Times what is stated: noise of less is not worth telling."""
LAGS, MANY = 3, 100
"""Samples by which what is white is not like itself, and from how many that can be told."""
WHITE = 2.5
"""Standard deviations of the autocorrelation of white noise."""


@frozen
class Noise:
    """The noise of one channel.

    Attributes:
        std: of a sample as recorded, in the channel's unit.
        correlation: samples that make one independent one (1 for white noise).
        trusted: False where the level is only an estimate from a filtered channel, in which noise and signal look alike;
            what a model leaves of such a channel is then compared by its size, not by `std`.
        least: the level below which a residual no longer counts as better; the estimate may be too large by half.
        louder: how many times what the recording states `std` is, where a model leaves white noise of more.
    """

    std: float
    correlation: float
    trusted: bool
    least: float = 0.0
    louder: float = 1.0

    @property
    def weight(self) -> float:
        """What a residual is multiplied by, so that its square counts as often as it is independent."""
        return 1.0 / (self.std * np.sqrt(self.correlation))


def channel_noise(instrument: xr.Dataset, quantity: str, channel: int, samples: np.ndarray, times: np.ndarray) -> Noise:
    """The noise of one channel of an instrument group: given by `<quantity>_std`, else estimated from the samples.

    Arguments:
        instrument: group of a recording.
        quantity: its recorded variable.
        channel: position along the dimension of channels.
        samples: (time,) of this channel; NaN where missing.
        times: (time,) s.
    """
    interval = float(np.median(np.diff(times))) if len(times) > 1 else 1.0
    filter_class = frequency_class(instrument)
    correlation = correlation_samples(filter_class, interval)
    declared = instrument.variables.get(f"{quantity}_std")
    std = float(np.ravel(declared.values)[channel]) if declared is not None else np.nan
    if np.isfinite(std) and std > 0:
        return Noise(std, correlation, trusted=True)
    present = samples[np.isfinite(samples)]
    if filter_class:
        estimate = filtered_std(present, interval, filter_class, correlation)
        return Noise(estimate, correlation, trusted=False, least=HALF * estimate)
    return Noise(_white_std(present), 1.0, trusted=True)


def _white_std(samples: np.ndarray) -> float:
    """White noise from fourth differences, which a smooth signal hardly has; samples at a limit, all alike, tell nothing."""
    differences = np.diff(samples, 4)
    moving = sliding_window_view(np.diff(samples), 4).any(axis=1) if len(samples) > 4 else np.zeros(0, dtype=bool)
    differences = differences[moving] if np.count_nonzero(moving) >= FEWEST else differences
    if len(differences) < FEWEST:
        return _positive(0.0, samples)
    # 70 = sum of squares of the binomial coefficients 1 4 6 4 1.
    return _positive(robust_std(differences) / np.sqrt(70.0), samples)


def as_heard(noise: Noise, left: np.ndarray) -> Noise:
    """The noise of a channel that states too little of it: of what a model leaves, `left` (time,), if all of that is white.

    What a structure does that the model does not say is smooth beside it.
    """
    present = left[np.isfinite(left)]
    if not noise.trusted or noise.correlation > 1.0 or len(present) < MANY:
        return noise
    level = float(np.sqrt(np.mean(present**2)))
    alike = [np.mean(present[lag:] * present[:-lag]) / level**2 for lag in range(1, 1 + LAGS)]
    if level < LOUDER * noise.std or np.max(np.abs(alike)) > WHITE / np.sqrt(len(present)):
        return noise
    return evolve(noise, std=level, louder=noise.louder * level / noise.std)


def robust_std(values: np.ndarray) -> float:
    """Standard deviation of normal noise about 0, from the median of its size: outliers hardly change it."""
    return float(np.median(np.abs(values)) / 0.6745)


def filtered_std(samples: np.ndarray, interval: float, filter_class: int, correlation: float) -> float:
    """Filtered noise from the spectrum about the filter's corner, where a structure moves least and noise still passes.

    Of readings, or of what a model leaves of them: below a low corner, or in a short test, a structure moves there, too.

    Arguments:
        samples: (time,) one each `interval`, s; filter_class: of their filter; correlation: samples for an independent one.
    """
    corner = CORNER * filter_class
    frequency, density = periodogram(samples, 1.0 / interval, window="hann")
    band = density[(frequency > 0.7 * corner) & (frequency < 1.2 * corner)]
    if len(band) < 4:
        return _positive(0.0, samples)
    # ln 2: the median of a periodogram's exponential distribution; 0.5: the filter's mean power gain over that band.
    level = np.median(band) / np.log(2.0) / 0.5
    return _positive(np.sqrt(level / (2.0 * interval * correlation)), samples)


def _positive(std: float, samples: np.ndarray) -> float:
    """A noise-free channel still has the resolution of its numbers."""
    scale = float(np.max(np.abs(samples), initial=0.0))
    return max(float(std), 1e-9 * scale, 1e-12)
