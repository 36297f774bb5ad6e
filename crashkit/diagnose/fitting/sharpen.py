"""Fits to recordings that are thinned in their own light, and what is found that outruns those that were thinned before."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.diagnose.fitting.evidence import FLOOR, Rival, is_unknown
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
THINNED = 0.5
"""Share of what a finding leaves above the noise that is due to thinning, if the finding outruns it."""


class OutrunError(Exception):
    """What was found moves faster than the thinned recordings can show, and has to be judged by finer ones.

    Attributes:
        found: that claim, fitted to those.
    """

    def __init__(self, found: Rival) -> None:
        super().__init__(found.identity)
        self.found = found


def check_pace(workshop: Workshop, given: Misfit, found: Rival) -> None:
    """Raises OutrunError where most of what a finding leaves above the noise was made by thinning."""
    left = found.search
    if not workshop.recorded or is_unknown(found) or left.normalised < FLOOR:
        return
    finer = sharpened(workshop.equipped([left.misfit.model]), given.model, workshop.recorded, left)
    if finer.excess < THINNED * left.excess:
        raise OutrunError(evolve(found, search=finer))


def check_rate(workshop: Workshop, given: Misfit, found: Rival) -> None:
    """Raises OutrunError where readings that a finding explains change faster than the thinned recordings show.

    However much else is left: the means that these consist of have taken away part of what rings.
    """
    left = found.search
    if not workshop.recorded:
        return
    equipped = workshop.equipped([left.misfit.model])
    finer = in_the_light_of(equipped, given.model, workshop.recorded, left.fitted())
    if finer.sample_count > left.misfit.sample_count:
        search = begin(workshop.identifier, equipped.misfit(finer, left.fitted().model)).advance(STEPS)
        raise OutrunError(evolve(found, search=search))


def sharpened(workshop: Workshop, model: Model, recordings: Mapping[str, xr.DataTree], search: Search) -> Search:
    """The fit to recordings that are thinned in its own light."""
    for _ in range(SHARPENINGS):
        found = search.fitted()
        thin = in_the_light_of(workshop, model, recordings, found)
        search = begin(workshop.identifier, workshop.misfit(thin, found.model)).advance(STEPS)
    return search


def in_the_light_of(workshop: Workshop, model: Model, recordings: Mapping[str, xr.DataTree], found: Misfit) -> Misfit:
    """A model's misfit to recordings that are thinned in the light of a fitted one, weighed alike."""
    thin = workshop.first_misfit(model, thinned_by(workshop, recordings, found.model))
    return weighed_alike(thin, found).with_prior(ROUGHLY)


def weighed_alike(unseen: Misfit, base: Misfit) -> Misfit:
    """Open noise levels of a sensor are those that the calibration left, of all its runs together."""
    noises: dict[tuple[str, str, str], list[Noise]] = {}
    for channel in base.channels:
        if not channel.noise.trusted:
            noises.setdefault((channel.instrument, channel.sensor, channel.axis), []).append(channel.noise)
    return unseen.with_levels({sensor: _together(own) for sensor, own in noises.items()})


def _together(noises: Sequence[Noise]) -> Noise:
    std = float(np.sqrt(np.mean([noise.std**2 for noise in noises])))
    return evolve(noises[0], std=std, least=min(noise.least for noise in noises))
