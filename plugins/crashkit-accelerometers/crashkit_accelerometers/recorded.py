"""Recordings that were never made: what sensors would have recorded of a given motion, noise and all."""

import numpy as np
import xarray as xr

from crashkit.data.channel_filter import filter_channel, frequency_class
from crashkit.protocols import Observer, SensorErrors

SETTLED = 400
"""Samples of noise before and after the recording, so that its filter has forgotten both ends."""


def recorded(
    observer: Observer,
    motion: xr.Dataset,
    instrument: xr.Dataset,
    errors: SensorErrors | None = None,
    resolution: float = 0.0,
    seed: int = 0,
) -> xr.Dataset:
    """What an instrument would record of a motion: its prediction, noise through its filter, and the steps of its digitiser.

    Arguments:
        observer: with the dims (time, channel, axis).
        motion: to be recorded.
        instrument: a group that says where the sensors are and when they read; its `<quantity>_std`, if any, is that of the
            noise as recorded, after the filter.
        errors: of the sensors.
        resolution: the smallest difference between two readings. It is no parameter to identify, as a reading does not
            change with it smoothly; its variance, resolution^2 / 12, is added to `<quantity>_std`.
        seed: of the noise.

    Returns:
        The group with its readings.
    """
    predicted = observer.predict(motion, instrument, errors)[observer.quantity]
    values = predicted.values.copy()
    stated = f"{observer.quantity}_std"
    std = instrument[stated].values if stated in instrument else np.zeros(values.shape[1])
    cfc = frequency_class(instrument)
    values += std[:, None] * _noise(values.shape, instrument["time"].values, cfc, seed)
    result = instrument.copy()
    if resolution:
        values = resolution * np.round(values / resolution)
        result[stated] = (observer.channel, np.hypot(std, resolution / np.sqrt(12.0)), {"units": predicted.attrs["units"]})
    result[observer.quantity] = (predicted.dims, values, dict(predicted.attrs))
    return result


def _noise(shape: tuple[int, ...], times: np.ndarray, channel_frequency_class: int, seed: int) -> np.ndarray:
    """Noise of variance 1, as it comes out of the filter."""
    white = np.random.default_rng(seed).normal(size=(shape[0] + 2 * SETTLED, *shape[1:]))
    if not channel_frequency_class:
        return white[SETTLED:-SETTLED]
    interval = (times[-1] - times[0]) / (len(times) - 1)
    stamps = interval * np.arange(len(white))
    impulse = (np.arange(len(white)) == len(white) // 2).astype(float)
    gain = np.sqrt(np.sum(filter_channel(impulse, stamps, channel_frequency_class) ** 2))
    return filter_channel(white, stamps, channel_frequency_class)[SETTLED:-SETTLED] / gain
