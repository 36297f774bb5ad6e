"""Thinner recordings for a search that tries many models: fast channels averaged to a rate that a structure cannot outrun."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import xarray as xr

from crashkit.data.channel_filter import filter_channel, frequency_class
from crashkit.data.filter_ends import UNSETTLED, unsettled

SEARCH_INTERVAL = 5e-4
"""s between samples of a search; a crash has little above 500 Hz."""
FILTER_MARGIN = 10.5
"""A channel filtered to class C needs more than 10 C samples a second for its filter (SAE J211)."""
OPEN_CLASS = 600
"""A filter of this class or above lets through all that a structure does."""
UNEVEN = 0.01
"""Of the usual step: samples whose steps differ by no more are evenly spaced."""
FEWEST = 8
"""Blocks that a channel must have: of less, too little would be left."""
NO_HALVINGS: Mapping[str, int] = MappingProxyType({})
MEMORY = 200
"""Samples after which such a filter has forgotten an impulse."""


def thinned(recording: xr.DataTree, quantities: Mapping[str, str], halvings: Mapping[str, int] = NO_HALVINGS) -> xr.DataTree:
    """The recording with every fast, evenly sampled instrument brought to about `SEARCH_INTERVAL`.

    White channels are averaged over blocks centred on the samples that are kept, so that little is lost but what lies above
    the new rate; so are those whose filter is open, which then counts for their noise alone. Other filtered channels, whose
    neighbours tell the same, are thinned.

    Arguments:
        recording: one test.
        quantities: the recorded variable by the value of a group's attribute `observer`.
        halvings: how often that interval is halved, by group.
    """
    changed = {
        name: xr.DataTree(
            _thin(group.to_dataset(inherit=False), quantities[str(group.attrs["observer"])], halvings.get(name, 0))
        )
        for name, group in recording.children.items()
        if str(group.attrs.get("observer")) in quantities
    }
    return recording.assign(changed)


def _thin(instrument: xr.Dataset, quantity: str, halvings: int) -> xr.Dataset:
    times = instrument["time"].values
    filter_class = frequency_class(instrument)
    is_closed = 0 < filter_class < OPEN_CLASS
    factor = samples_in(times, 0.5**halvings * search_interval(filter_class if is_closed else 0))
    factor = factor if is_closed else whole_block(factor)
    if factor < 2 or len(times) < FEWEST * factor:
        return instrument
    if filter_class:
        instrument = instrument.assign_attrs({UNSETTLED: unsettled(instrument, quantity)})
    if is_closed:
        return instrument.isel(time=in_step(times, factor))
    return _averaged(instrument, quantity, factor, filter_class)


def samples_in(times: np.ndarray, interval: float) -> int:
    """How many samples there are in an interval, s; 1 where they are not evenly spaced, or there are fewer than two."""
    steps = np.diff(times)
    if len(steps) == 0:
        return 1
    usual = float(np.median(steps))
    return int(interval / usual + 1e-6) if np.ptp(steps) <= UNEVEN * usual else 1


def whole_block(factor: int) -> int:
    """Samples of a block that is averaged: of two with a middle, one shares too much with the next."""
    return 3 if factor == 2 else factor


def search_interval(filter_class: int) -> float:
    """s between the samples that a search needs of a channel of that class, 0 for unfiltered."""
    return min(SEARCH_INTERVAL, 1.0 / (FILTER_MARGIN * filter_class)) if filter_class else SEARCH_INTERVAL


def in_step(times: np.ndarray, factor: int, margin: int = 0) -> np.ndarray:
    """Every so many of evenly spaced samples, those at multiples of that interval from t = 0.

    There other instruments are read too, and a simulation has fewer instants to tell.

    Arguments:
        margin: samples at both ends that are not taken.
    """
    interval = float(np.median(np.diff(times)))
    first = margin + -(margin + round(float(times[0]) / interval)) % factor
    return np.arange(first, len(times) - margin, factor)


def _averaged(instrument: xr.Dataset, quantity: str, factor: int, filter_class: int) -> xr.Dataset:
    """Weighted means of blocks and their neighbours, which reach equally far to both sides of a kept sample."""
    readings, times = instrument[quantity].transpose("time", ...), instrument["time"].values
    kept, means = block_means(readings.values, times, factor)
    thin = instrument.isel(time=kept)
    thin[quantity] = (readings.dims, means, instrument[quantity].attrs)
    if f"{quantity}_std" in thin:
        thin[f"{quantity}_std"] = thin[f"{quantity}_std"] * noise_left(times, factor, filter_class)
    return thin.assign_attrs(channel_frequency_class=0) if filter_class else thin


def block_means(samples: np.ndarray, times: np.ndarray, factor: int) -> tuple[np.ndarray, np.ndarray]:
    """Weighted means of blocks of evenly spaced samples (time, ...), and which samples they are centred on."""
    weights = _weights(factor)
    half = len(weights) // 2
    kept = in_step(times, factor, half)
    return kept, np.sum([weight * samples[kept + shift - half] for shift, weight in enumerate(weights)], axis=0)


def _weights(factor: int) -> np.ndarray:
    """Of a block and its two neighbours, so that the mean is the value at the centre for every parabola.

    The plain mean of a block is off by a share of the curvature: for a light body on a stiff spring far above the noise. Of a
    block of an even number, which has no middle, the ends are shared with the neighbours.
    """
    block = np.full(factor, 1.0 / factor)
    if factor % 2 == 0:
        block = np.convolve(block, (0.5, 0.5))
    away = np.arange(len(block)) - len(block) // 2
    curvature = float(block @ away**2) / (2.0 * factor**2)
    beside = np.zeros(2 * factor + 1)
    beside[::factor] = -curvature, 1.0 + 2.0 * curvature, -curvature
    return np.convolve(block, beside)


def noise_left(times: np.ndarray, factor: int, filter_class: int) -> float:
    """Standard deviation of such a mean, relative to that of a sample of white noise that went through the filter."""
    response = np.zeros(2 * MEMORY + 1)
    response[MEMORY] = 1.0
    if filter_class:
        stamps = (times[1] - times[0]) * np.arange(len(response))
        response = filter_channel(response, stamps, filter_class)
    return float(np.linalg.norm(np.convolve(response, _weights(factor))) / np.linalg.norm(response))
