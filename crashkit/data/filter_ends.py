"""Where a filter that knew nothing of before and after a record has made up its ends."""

import math

import numpy as np
import xarray as xr

from crashkit.data.channel_filter import DESIGN_FREQUENCY, ChannelFilter, frequency_class

UNSETTLED = "unsettled"
"""Attribute of an instrument whose record was looked at already."""
FORGOTTEN = 6.0
"""Time constants of the filter: after these 1/400 of what it has made up is left."""
AT_REST = 0.5
"""Of what a filter that was told of the rest before shows at the first sample of a ramp: a record that shows less was not."""
SEEN = 5.0
"""Standard deviations of a reading, that much of which must be expected there to say so."""


def unsettled(instrument: xr.Dataset, quantity: str) -> float:
    """For how long, s, a record says at its ends what its filter has made up; 0 where that was told of the rest before it.

    Both passes of the filter spread a rise: one from rest has come to some part of itself by the time it begins. A filter that
    has only the record continues it at both ends, mostly mirrored in its first and last sample, and that shows nothing there.
    Of a ramp s t from t = 0 the former shows s times the integral of t h(t) over t > 0, h the response to an impulse.

    Arguments:
        instrument: a group of a recording, with the attribute `channel_frequency_class`, Hz.
        quantity: its recorded variable, (time, channel, axis).
    """
    if UNSETTLED in instrument.attrs:
        return float(instrument.attrs[UNSETTLED])
    cfc, times = frequency_class(instrument), instrument["time"].values.astype(float)
    if not cfc:
        return 0.0
    forgotten = FORGOTTEN * math.sqrt(2.0) / (2.0 * math.pi * DESIGN_FREQUENCY * cfc)
    if len(times) < 2 or times[-1] - times[0] < 4.0 * forgotten or times[0] < -forgotten:
        return 0.0
    readings = instrument[quantity].transpose("time", ...).values.reshape(len(times), -1)
    return forgotten if _is_made_up(readings, _noise(instrument, quantity, readings), times, cfc) else 0.0


def _is_made_up(readings: np.ndarray, noise: np.ndarray, times: np.ndarray, cfc: int) -> bool:
    """Whether channels (time, channel) that rise at once do not show that they had begun to before."""
    ramp = np.arange(len(times), dtype=float)[:, None]
    shown = ChannelFilter.of(times, cfc).filtered(ramp, 0.0)[:, 0]
    ahead = math.ceil(shown[0])
    expected = (readings[ahead] - readings[0]) * shown[0] / (shown[ahead] - shown[0])
    is_seen = np.abs(expected) > SEEN * noise
    return bool(is_seen.any() and np.all(readings[0, is_seen] / expected[is_seen] < AT_REST))


def _noise(instrument: xr.Dataset, quantity: str, readings: np.ndarray) -> np.ndarray:
    """Standard deviation of each channel as it is told, and a hundredth of its largest reading where it is not."""
    largest = 0.01 * np.nanmax(np.abs(readings), axis=0, initial=0.0)
    told = instrument.variables.get(f"{quantity}_std")
    if told is None:
        return largest
    std = np.repeat(np.ravel(told.values.astype(float)), readings.shape[1] // told.size)
    return np.where(np.isfinite(std) & (std > 0.0), std, largest)
