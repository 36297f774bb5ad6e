"""Motions with known derivatives: stops from 50 km/h, as film shows them, and as accelerometers do after their filter."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.data.channel_filter import filter_channel

SPEED = 50.0 / 3.6
NOISE = 1e-3
"""m"""
BANDWIDTH = 10.0
"""Hz, that of a stop of 0.1 s, for the peers that have to be told."""
FINE = 400_001


@frozen
class Recorded:
    """Samples and what they hide.

    Attributes:
        times: (sample,) s.
        samples: (sample,) m.
        truth: position, velocity and acceleration, (3, sample).
        noise: standard deviation of a sample.
    """

    times: np.ndarray
    samples: np.ndarray
    truth: np.ndarray
    noise: float

    @property
    def channel(self) -> xr.DataArray:
        """As a smoother takes them."""
        return xr.DataArray(self.samples, {"time": self.times}, ("time",))


def film(acceleration: Callable[[np.ndarray], np.ndarray], times: np.ndarray, draw: int, noise: float = NOISE) -> Recorded:
    """The position of a body that starts at SPEED and has this acceleration, with white noise."""
    fine = np.linspace(0.0, times[-1], FINE)
    step = fine[1]
    a = acceleration(fine)
    v = SPEED + step * np.concatenate([[0.0], np.cumsum(0.5 * (a[1:] + a[:-1]))])
    x = step * np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]))])
    truth = np.stack([np.interp(times, fine, x), np.interp(times, fine, v), acceleration(times)])
    return Recorded(times, truth[0] + np.random.default_rng(draw).normal(scale=noise, size=len(times)), truth, noise)


def accelerometer(acceleration: Callable[[np.ndarray], np.ndarray], cfc: int, draw: int, noise: float) -> Recorded:
    """The acceleration at 10 kHz with white noise, both through the filter of a frequency class; only `truth[0]` is known."""
    times = np.arange(1500) * 1e-4
    truth = filter_channel(acceleration(times), times, cfc)
    error = filter_channel(np.random.default_rng(draw).normal(scale=noise, size=len(times)), times, cfc)
    return Recorded(times, truth + error, np.stack([truth, truth, truth]), float(np.std(error)))


def even(count: int, duration: float = 0.199) -> np.ndarray:
    """Equal steps; 200 of them are those of film at 1 kHz."""
    return np.linspace(0.0, duration, count)


def uneven(count: int) -> np.ndarray:
    """Steps between 0.2 and 1.8 times the mean."""
    times = np.cumsum(np.random.default_rng(0).uniform(0.2, 1.8, count))
    return (times - times[0]) / (times[-1] - times[0]) * 0.199


def half_sine(times: np.ndarray) -> np.ndarray:
    """From 20 to 120 ms."""
    phase = np.clip((times - 0.02) / 0.1, 0.0, 1.0)
    return -SPEED * np.pi / 0.2 * np.sin(np.pi * phase)


def sine_squared(times: np.ndarray) -> np.ndarray:
    """The same without corners."""
    phase = np.clip((times - 0.02) / 0.1, 0.0, 1.0)
    return -SPEED / 0.05 * np.sin(np.pi * phase) ** 2


def trapezoid(times: np.ndarray) -> np.ndarray:
    """Four corners."""
    return np.interp(times, [0.02, 0.03, 0.09, 0.12], [0.0, -180.0, -180.0, 0.0])


def rippled(times: np.ndarray) -> np.ndarray:
    """A half sine with a burst of 45 Hz: rough for a while, quiet for long."""
    return half_sine(times) * (1.0 + 0.5 * np.sin(90.0 * np.pi * (times - 0.02)) * np.exp(-(((times - 0.05) / 0.02) ** 2)))


def two_peaks(times: np.ndarray) -> np.ndarray:
    """Two short blows."""
    return -150.0 * np.exp(-(((times - 0.045) / 0.008) ** 2)) - 250.0 * np.exp(-(((times - 0.085) / 0.012) ** 2))


def blow(times: np.ndarray) -> np.ndarray:
    """An even braking that begins and ends at once, at 20.5 and 119.5 ms."""
    return np.where((times > 0.0205) & (times < 0.1195), -SPEED / 0.099, 0.0)


CONTACTS = (0.0205, 0.1195)
PULSES = {
    "half sine": half_sine,
    "sine squared": sine_squared,
    "trapezoid": trapezoid,
    "half sine with ripple": rippled,
    "two peaks": two_peaks,
    "rectangle": blow,
}
