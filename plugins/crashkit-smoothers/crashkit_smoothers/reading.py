"""A channel as a smoother reads it: time without a unit, missing samples left out, each sample with its scale."""

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.data.channel_filter import correlation_samples, frequency_class
from crashkit.errors import CrashkitError

ROUNDING = 1e-15


@frozen
class Reading:
    """The samples of one channel.

    Attributes:
        time: the coordinate, as given.
        x: (time,) of all instants, on [0, 1].
        present: (time,) where there is a sample.
        z: (sample,).
        scale: (sample,) one over the standard deviation if that is known, over the root of `correlation`.
        correlation: samples that make one independent one.
        std: standard deviation of a sample if known (the median if they differ), else None.
        duration: s, the length of [0, 1].
        units: of the samples, "" if they do not say.
    """

    time: xr.DataArray
    x: np.ndarray
    present: np.ndarray
    z: np.ndarray
    scale: np.ndarray
    correlation: float
    std: float | None
    duration: float
    units: str

    @property
    def count(self) -> float:
        """How many independent samples there are."""
        return len(self.z) / self.correlation

    @property
    def rounding(self) -> float:
        """What the rounding of their digits adds to a scaled sum of squares."""
        return self.count * float(ROUNDING * np.max(np.abs(self.z)) * np.max(self.scale)) ** 2


def read_channel(name: str, samples: xr.DataArray, std: float | xr.DataArray | None, fewest: int) -> Reading:
    """The samples of a channel, as `Smoother.smooth` takes them.

    Raises CrashkitError where fewer than `fewest` are independent, where time does not increase, where a standard deviation
    is not positive.
    """
    times = _increasing(name, samples)
    values = samples.values.astype(float)
    spread = np.broadcast_to(1.0 if std is None else np.asarray(std, dtype=float), values.shape)
    present = np.isfinite(values)
    if not (spread[present] > 0.0).all():
        raise CrashkitError(f"{name}: expected standard deviations above 0, found {np.min(spread[present])}")
    filter_class = frequency_class(samples)
    correlation = correlation_samples(filter_class, float(np.median(np.diff(times)))) if filter_class else 1.0
    count = present.sum() / correlation
    if count < fewest:
        of_filter = f" independent ones (CFC{filter_class})" if filter_class else ""
        raise CrashkitError(f"{name}: expected at least {fewest} samples, found {count:.3g}{of_filter}")
    duration = float(times[-1] - times[0])
    return Reading(
        time=samples["time"],
        x=(times - times[0]) / duration,
        present=present,
        z=values[present],
        scale=1.0 / (spread[present] * np.sqrt(correlation)),
        correlation=correlation,
        std=None if std is None else float(np.median(spread[present])),
        duration=duration,
        units=str(samples.attrs.get("units", "")),
    )


def _increasing(name: str, samples: xr.DataArray) -> np.ndarray:
    if samples.dims != ("time",) or "time" not in samples.coords:
        raise CrashkitError(f"{name}: expected samples over time with its coordinate, found dims {samples.dims}")
    times = samples["time"].values.astype(float)
    if len(times) > 1 and not (np.diff(times) > 0.0).all():
        place = int(np.argmin(np.diff(times)))
        raise CrashkitError(f"{name}: expected increasing times, found {times[place]:g} s before {times[place + 1]:g} s")
    return times
