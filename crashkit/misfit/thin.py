"""Thinner recordings for a search that tries many models: fast channels averaged to a rate that a structure cannot outrun."""

import numpy as np
import xarray as xr

from crashkit.data.channel_filter import filter_channel

SEARCH_INTERVAL = 5e-4
"""s between samples of a search; a crash has little above 500 Hz."""
FILTER_MARGIN = 10.5
"""A channel filtered to class C needs more than 10 C samples a second for its filter (SAE J211)."""
OPEN_CLASS = 600
"""A filter of this class or above lets through all that a structure does."""
MEMORY = 200
"""Samples after which such a filter has forgotten an impulse."""


def thinned(recording: xr.DataTree, quantities: dict[str, str]) -> xr.DataTree:
    """The recording with every fast, evenly sampled instrument brought to about `SEARCH_INTERVAL`.

    White channels are averaged over blocks centred on the samples that are kept, so that nothing is lost but what lies above
    the new rate; so are those whose filter is open, which then counts for their noise alone. Other filtered channels, whose
    neighbours tell the same, are thinned.

    Arguments:
        recording: one test.
        quantities: the recorded variable by the value of a group's attribute `observer`.
    """
    changed = {
        name: xr.DataTree(_thin(group.to_dataset(inherit=False), quantities[str(group.attrs["observer"])]))
        for name, group in recording.children.items()
        if str(group.attrs.get("observer")) in quantities
    }
    return recording.assign(changed)


def _thin(instrument: xr.Dataset, quantity: str) -> xr.Dataset:
    times = instrument["time"].values
    steps = np.diff(times)
    interval = float(np.median(steps)) if len(steps) else SEARCH_INTERVAL
    filter_class = int(instrument.attrs.get("channel_frequency_class", 0))
    is_closed = 0 < filter_class < OPEN_CLASS
    wanted = min(SEARCH_INTERVAL, 1.0 / (FILTER_MARGIN * filter_class)) if is_closed else SEARCH_INTERVAL
    factor = int(wanted / interval + 1e-6)
    if factor < 2 or np.ptp(steps) > 0.01 * interval:
        return instrument
    if is_closed:
        return instrument.isel(time=slice(None, None, factor))
    return _averaged(instrument, quantity, factor if factor % 2 else factor - 1, filter_class)


def _averaged(instrument: xr.Dataset, quantity: str, factor: int, filter_class: int) -> xr.Dataset:
    """Means of odd blocks; the block of a kept sample reaches equally far to both sides."""
    half = factor // 2
    kept = np.arange(factor, instrument.sizes["time"] - half, factor)
    values = instrument[quantity].transpose("time", ...).values
    means = np.mean([values[kept + shift] for shift in range(-half, half + 1)], axis=0)
    thin = instrument.isel(time=kept)
    thin[quantity] = (instrument[quantity].transpose("time", ...).dims, means, instrument[quantity].attrs)
    if f"{quantity}_std" in thin:
        thin[f"{quantity}_std"] = thin[f"{quantity}_std"] * _noise_left(instrument["time"].values, factor, filter_class)
    return thin.assign_attrs(channel_frequency_class=0) if filter_class else thin


def _noise_left(times: np.ndarray, factor: int, filter_class: int) -> float:
    """Standard deviation of a mean, relative to that of a sample of white noise that went through the filter."""
    response = np.zeros(2 * MEMORY + 1)
    response[MEMORY] = 1.0
    if filter_class:
        stamps = (times[1] - times[0]) * np.arange(len(response))
        response = filter_channel(response, stamps, filter_class)
    mean = np.convolve(response, np.full(factor, 1.0 / factor))
    return float(np.linalg.norm(mean) / np.linalg.norm(response))
