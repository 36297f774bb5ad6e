"""The low-pass filters of crash testing: the channel frequency classes (CFC) of SAE J211 and ISO 6487."""

import math

import numpy as np
import xarray as xr
from attrs import frozen
from numba import njit

from crashkit.errors import CrashkitError

DESIGN_FREQUENCY = 2.0775  # times the class: one pass is -3 dB here, both passes are -3 dB at 1.667 times the class
CORNER = 5.0 / 3.0  # times the class: up to where both passes let pass, Hz
TIME_CONSTANTS = 20.0  # after which a transient is forgotten to 2e-9
UNIFORMITY = 0.01  # of the sampling interval


def frequency_class(instrument: xr.Dataset | xr.DataArray) -> int:
    """The class that the channels of an instrument were filtered to, Hz; 0 for unfiltered."""
    return int(instrument.attrs.get("channel_frequency_class", 0))


def filter_channel(
    values: np.ndarray, times: np.ndarray, cfc: float, axis: int = 0, before: float | np.ndarray | None = None
) -> np.ndarray:
    """Filter channels to a frequency class: a second-order Butterworth filter run forward and backward.

    The gain at the frequency f is 1 / (1 + (f / 2.0775 CFC)^4). The filter is linear, so sensitivities pass through it as
    channels do; a NaN spreads over its whole channel.

    Arguments:
        values: samples along `axis`; every other dim is a channel of its own.
        times: s, uniform.
        cfc: channel frequency class in Hz; 0 returns the values as they are.
        axis: of time.
        before: the constant that the channels had before the first sample, by default their first sample. Motion is
            uniform before an impact, so that a simulated acceleration or force has 0. After the end the last sample stays.

    Returns:
        The filtered samples, in the shape of `values`.

    Raises CrashkitError where the sampling is not uniform or too slow for the class.

    SAE J211-1, appendix C.
    """
    if cfc == 0:
        return values
    samples = np.moveaxis(np.asarray(values, dtype=float), axis, 0)
    if len(samples) < 2:
        return values
    start = samples[0] if before is None else np.broadcast_to(before, samples.shape[1:])
    return np.moveaxis(ChannelFilter.of(times, cfc).filtered(samples, start), 0, axis)


@frozen
class ChannelFilter:
    """The filter of a class at one sampling rate, for samples that are filtered again and again.

    Arguments:
        warped: tan(pi f T), the design frequency as the bilinear transform sees it.
        memory: samples after which a transient is forgotten.
    """

    warped: float
    memory: int

    @classmethod
    def of(cls, times: np.ndarray, cfc: float) -> "ChannelFilter":
        """The filter of class `cfc`, Hz, for samples at `times`, s; raises as `filter_channel` does."""
        warped = _warped_frequency(cfc, _interval(np.asarray(times)))
        return cls(warped, _memory(warped))

    def filtered(self, samples: np.ndarray, before: np.ndarray | float) -> np.ndarray:
        """Samples (time, ...) filtered, which were `before` until the first."""
        padded = np.empty((len(samples) + self.memory, samples[0].size))
        padded[: len(samples)] = samples.reshape(len(samples), -1)
        padded[len(samples) :] = padded[len(samples) - 1]
        start = np.empty(samples.shape[1:])
        start[...] = before
        _pass(padded, self.warped, start.ravel(), 0, len(padded), 1)
        _pass(padded, self.warped, padded[-1].copy(), len(padded) - 1, -1, -1)
        return padded[: len(samples)].reshape(samples.shape)


def since_contact(at: np.ndarray) -> np.ndarray:
    """Instants, s, of the samples that a record which begins after t = 0 lacks, and a filter, or a mount, remembers.

    Arguments:
        at: s, evenly spaced instants of its samples.
    """
    if len(at) < 2 or at[0] <= 0.0:
        return np.empty(0)
    interval = (at[-1] - at[0]) / (len(at) - 1)
    return at[0] - interval * np.arange(np.ceil(at[0] / interval - UNIFORMITY), 0.0, -1.0)


def correlation_samples(cfc: float, interval: float) -> float:
    """How many samples of filtered white noise count as one independent sample, for signals slower than the class.

    The sum of the noise's autocorrelation over all lags, which is its spectrum at 0 over its variance, 1 / sum(h^2) with h
    the impulse response of both passes: 16.0 for CFC180 at 10 kHz, 1 for a class of 0. It is the number for means, integrals
    and fits; to estimate the variance of such noise one sample in 12.9 counts, the sum of the squared autocorrelation.

    Arguments:
        cfc: channel frequency class in Hz.
        interval: s, between samples.
    """
    if cfc == 0:
        return 1.0
    reach = _memory(_warped_frequency(cfc, interval))
    impulse = np.zeros(2 * reach + 1)
    impulse[reach] = 1.0
    response = filter_channel(impulse, interval * np.arange(len(impulse)), cfc)
    return float(1.0 / np.sum(response**2))


def _interval(times: np.ndarray) -> float:
    steps = np.diff(times)
    interval = float(times[-1] - times[0]) / len(steps)
    if np.abs(steps - interval).max() > UNIFORMITY * interval:
        raise CrashkitError(
            "a filtered channel must be sampled uniformly: "
            f"expected every {interval:.4g} s, found steps from {steps.min():.4g} s to {steps.max():.4g} s"
        )
    return interval


def _warped_frequency(cfc: float, interval: float) -> float:
    """tan(pi f T): the design frequency as the bilinear transform sees it."""
    if 2.0 * DESIGN_FREQUENCY * cfc * interval >= 1.0:
        raise CrashkitError(
            f"the sampling is too slow for CFC{cfc:g}: "
            f"expected more than {2.0 * DESIGN_FREQUENCY * cfc:.0f} Hz, found {1.0 / interval:.0f} Hz"
        )
    return math.tan(math.pi * DESIGN_FREQUENCY * cfc * interval)


def _memory(wa: float) -> int:
    """The number of samples after which a transient of the filter is forgotten."""
    return math.ceil(TIME_CONSTANTS * (wa + 1.0 / wa) / math.sqrt(2.0))


@njit(cache=True)
def _pass(samples: np.ndarray, wa: float, start: np.ndarray, first: int, end: int, step: int) -> None:  # pragma: no cover
    """Run the recursion of SAE J211 over the rows of `samples`, in place, from the steady state at `start`."""
    scale = 1.0 + math.sqrt(2.0) * wa + wa * wa
    a = wa * wa / scale
    b1 = 2.0 * (1.0 - wa * wa) / scale
    b2 = (math.sqrt(2.0) * wa - 1.0 - wa * wa) / scale
    next_one = (1.0 - a) * start
    next_two = (a + b2) * start
    for row in range(first, end, step):
        now = samples[row]  # a row by itself is vectorised
        for channel in range(now.size):
            value = now[channel]
            filtered = a * value + next_one[channel]
            next_one[channel] = 2.0 * a * value + b1 * filtered + next_two[channel]
            next_two[channel] = a * value + b2 * filtered
            now[channel] = filtered
