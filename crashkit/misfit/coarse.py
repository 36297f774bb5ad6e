"""Fewer instants of an instrument, or only the first: what a search needs until it is near its end."""

import numpy as np
from attrs import evolve

from crashkit.data.channel_filter import CORNER, frequency_class
from crashkit.misfit.channel import Channel, Group
from crashkit.misfit.thin import (
    FILTER_MARGIN,
    OPEN_CLASS,
    SEARCH_INTERVAL,
    block_means,
    in_step,
    noise_left,
    samples_in,
    whole_block,
)

INSTANTS = 100
"""That a channel keeps, if it has as many."""
FEWEST = 3
"""Samples in which a search can see anything."""
COARSER = 4.0
"""By how much steps of the integration are longer; a few instants do not deserve more."""

PERIODS = 1.5
"""Of a filter's corner, after which less than a hundredth of a step is still to come."""


def coarse_group(group: Group) -> Group:
    """Every so many samples of a group, no fewer than its filter bears; where that is open, means instead of what it shows.

    Whatever a model does between such means: a first guess need not follow it there.
    """
    group = _opened(group)
    factor = _factor(group)
    if factor == 1:
        return group
    kept = in_step(group.times, factor)
    recorded = group.recorded[kept]
    channels = tuple(_thinned(channel, recorded[:, i], factor) for i, channel in enumerate(group.channels))
    dataset = group.dataset.isel(time=kept)
    return evolve(group, dataset=dataset, times=group.times[kept], recorded=recorded, channels=channels)


def early_group(group: Group, end: float) -> Group | None:
    """The samples of a group up to a time, s; None where that is too few.

    What is filtered also shows what comes a little later, which has to be simulated and is not compared.
    """
    count, reach = np.searchsorted(group.times, (end, end + _ahead(group)), side="right")
    if count < FEWEST:
        return None
    recorded = group.recorded[:reach].copy()
    recorded[count:] = np.nan
    channels = tuple(
        evolve(channel, samples=int(np.isfinite(recorded[:, i]).sum())) for i, channel in enumerate(group.channels)
    )
    dataset = group.dataset.isel(time=slice(reach))
    return evolve(group, dataset=dataset, times=group.times[:reach], recorded=recorded, channels=channels)


def _ahead(group: Group) -> float:
    """How far ahead a filtered channel sees, s."""
    cfc = frequency_class(group.dataset)
    return PERIODS / (CORNER * cfc) if cfc else 0.0


def _factor(group: Group) -> int:
    """A power of two: what is read at the same instants at first then still is."""
    many, cfc = len(group.times) // INSTANTS, frequency_class(group.dataset)
    if cfc:
        many = min(many, samples_in(group.times, 1.0 / (FILTER_MARGIN * cfc)))
    return 1 if many < 2 else 1 << (many.bit_length() - 1)


def _opened(group: Group) -> Group:
    """The group as means over blocks, where it went through a filter that lets through all that a structure does."""
    cfc, factor = frequency_class(group.dataset), whole_block(samples_in(group.times, SEARCH_INTERVAL))
    if cfc < OPEN_CLASS or factor < 2 or len(group.times) < INSTANTS * factor:
        return group
    kept, recorded = block_means(group.recorded, group.times, factor)
    left = noise_left(group.times, factor, cfc)
    channels = tuple(_averaged(channel, recorded[:, i], left) for i, channel in enumerate(group.channels))
    dataset = group.dataset.isel(time=kept).assign_attrs(channel_frequency_class=0)
    return evolve(group, dataset=dataset, times=group.times[kept], recorded=recorded, channels=channels)


def _averaged(channel: Channel, samples: np.ndarray, left: float) -> Channel:
    noise = channel.noise
    noise = evolve(noise, std=left * noise.std, least=left * noise.least, correlation=1.0)
    return evolve(channel, noise=noise, samples=int(np.isfinite(samples).sum()))


def _thinned(channel: Channel, samples: np.ndarray, factor: int) -> Channel:
    noise = evolve(channel.noise, correlation=max(1.0, channel.noise.correlation / factor))
    return evolve(channel, noise=noise, samples=int(np.isfinite(samples).sum()))
