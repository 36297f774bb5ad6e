"""Fits to recordings that are thinned in their own light."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.diagnose.fitting.search import STEPS, Search, begin
from crashkit.diagnose.fitting.thinning import thinned_by
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit, Noise
from crashkit.model import Model

SHARPENINGS = 2
"""How often recordings are thinned anew in the light of what was fitted to them."""
ROUGHLY = 0.3
"""Relative deviation to which the numbers of a given model are believed while causes are compared. Without it a model could
hide what it lacks in numbers that nobody would give it; how well a number is known is told without it."""


def sharpened(workshop: Workshop, model: Model, recordings: Mapping[str, xr.DataTree], search: Search) -> Search:
    """The fit to recordings that are thinned in its own light."""
    for _ in range(SHARPENINGS):
        found = search.fitted()
        thin = in_the_light_of(workshop, model, recordings, found)
        search = begin(workshop.identifier, workshop.misfit(thin, found.model)).advance(STEPS)
    return search


def as_heard(search: Search) -> Search:
    """The fit with channels that state too little noise weighed by what it leaves of them, if that is white."""
    heard = search.fitted().as_heard(search.point)
    if all(channel.noise.louder == 1.0 for channel in heard.channels):
        return search
    return begin(search.identifier, heard).advance(STEPS)


def in_the_light_of(workshop: Workshop, model: Model, recordings: Mapping[str, xr.DataTree], found: Misfit) -> Misfit:
    """A model's misfit to recordings that are thinned in the light of a fitted one, weighed alike."""
    thin = workshop.first_misfit(model, thinned_by(workshop, recordings, found.model))
    return weighed_alike(thin, found).with_prior(ROUGHLY)


def weighed_alike(unseen: Misfit, base: Misfit) -> Misfit:
    """Open noise levels of a sensor, and those louder than stated, are those that the calibration left, of all its runs
    together."""
    noises: dict[tuple[str, str, str], list[Noise]] = {}
    for channel in base.channels:
        if not channel.noise.trusted or channel.noise.louder > 1.0:
            noises.setdefault((channel.instrument, channel.sensor, channel.axis), []).append(channel.noise)
    return unseen.with_levels({sensor: _together(own) for sensor, own in noises.items()})


def _together(noises: Sequence[Noise]) -> Noise:
    std = float(np.sqrt(np.mean([noise.std**2 for noise in noises])))
    louder = float(np.sqrt(np.mean([noise.louder**2 for noise in noises])))
    return evolve(noises[0], std=std, least=min(noise.least for noise in noises), louder=louder)
