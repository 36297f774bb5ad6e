"""Re-identify first: the given model's own parameters, fitted to all calibration runs together."""

from functools import partial
from typing import Any

import numpy as np

from crashkit.campaign import spread
from crashkit.diagnose.regress import regression
from crashkit.diagnose.search import STEPS, Search, advance_all, begin, begin_all, weighed
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier, Status

FINDING = 400
"""Steps of the search that looks everywhere."""
EARLIEST, SLICES, STEPS_EACH = 0.1, 46, 12
"""Share of the time recorded that is looked at first, in how many slices all of it is, and the steps in each."""
SCATTER = 0.07
"""Relative scatter of the starts about the given values."""
HEATS = ((10, 6), (4, 10), (2, STEPS))
"""How many starts enter each heat, and how many steps each gets there."""
REFINING = ((12, 8), (4, STEPS))
"""The same about values that are already good."""


def reidentify(workshop: Workshop, misfit: Misfit) -> Search:
    """The best fit of the model as it is; what then remains, no tuning of its parameters removes.

    A model has many local optima where thresholds are crossed, so four searches look everywhere: the workshop's finder, one
    from many starts, and from where the equations of motion lead one at once and one that takes in the events as they come.
    """
    identifier = workshop.identifier
    looks = [partial(_found, workshop.finder), partial(_best_of_many, identifier), partial(_led, workshop)]
    ends = [end for each in spread(lambda look: look(misfit), looks) for end in each]
    searches = [begin(identifier, misfit.with_values(misfit.values(end))).advance(STEPS) for end in ends]
    return weighed([min(searches, key=lambda search: search.state.cost)])[0]


def _found(finder: Identifier[Any], misfit: Misfit) -> list[np.ndarray]:
    state = finder.start(misfit)
    for _ in range(FINDING):
        if state.status is not Status.RUNNING:
            break
        state = finder.step(misfit, state)
    return [np.asarray(state.point)]


def _led(workshop: Workshop, misfit: Misfit) -> list[np.ndarray]:
    """Where the regression ends, or the misfit's own values where there is none, and where a search goes from there."""
    end = regression(workshop, [misfit])
    start = misfit.start() if end is None else misfit.start_at(end[0])
    return [start, _grown(workshop, misfit, start)]


def _grown(workshop: Workshop, misfit: Misfit, start: np.ndarray) -> np.ndarray:
    """Where a search ends that sees a little more of the time recorded every few steps, so that no event is jumped over."""
    values = misfit.values(start)
    slices = [misfit.coarse.up_to(share) for share in np.linspace(EARLIEST, 1.0, SLICES).tolist()]
    for early in (one for one in slices if one.groups):
        search = begin(workshop.identifier, early.with_values(values)).advance(STEPS_EACH)
        values = early.values(search.point)
    return misfit.start_at(values)


def refine(identifier: Identifier[Any], misfit: Misfit) -> Search:
    """The fit from values that are already good, and from others about them: a better optimum may be near."""
    searches = begin_all(identifier, scattered(misfit, REFINING[0][0]))
    for size, steps in REFINING:
        searches = advance_all(sorted(searches, key=lambda search: search.deviance)[:size], steps)
    return min(searches, key=lambda search: search.deviance)


def _best_of_many(identifier: Identifier[Any], misfit: Misfit) -> list[np.ndarray]:
    """Where the best of several searches ends that begin at the model's values and around them."""
    searches = begin_all(identifier, scattered(misfit, HEATS[0][0]))
    for size, steps in HEATS:
        searches = advance_all(sorted(searches, key=lambda search: search.state.cost)[:size], steps)
    return [min(searches, key=lambda search: search.state.cost).point]


def scattered(misfit: Misfit, count: int) -> list[Misfit]:
    """The misfit at its model's values, and at others scattered about them within the bounds; the same each time."""
    start, (lower, upper) = misfit.start(), misfit.bounds()
    relative = np.abs(misfit.parameters(start)) / misfit.scaling(start)
    scatter = np.random.default_rng(0).normal(0.0, SCATTER, (count - 1, len(start)))
    points = [start, *(np.clip(start + move * relative, lower, upper) for move in scatter)]
    return [misfit.with_values(misfit.values(point)) for point in points]
