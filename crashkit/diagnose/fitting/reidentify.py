"""Re-identify first: the given model's own parameters, fitted to all calibration runs together."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crashkit.campaign import spread
from crashkit.diagnose.fitting.back_to_given import begun_from_given
from crashkit.diagnose.fitting.continuation import grown
from crashkit.diagnose.fitting.evidence import UNEXPLAINED, explains
from crashkit.diagnose.fitting.quadratic import tangent
from crashkit.diagnose.fitting.regress import regression
from crashkit.diagnose.fitting.search import STEPS, Search, advance_all, begin, begin_all, meet, weighed
from crashkit.diagnose.fitting.thresholds import wakened
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier, advanced

FINDING = 400
"""Steps of the search that looks everywhere."""
SCATTER = 0.07
"""Relative scatter of the starts about the given values."""
HEATS = ((10, 6), (4, 10), (2, STEPS))
"""How many starts enter each heat, and how many steps each gets there."""
REFINING = ((12, 8), (4, STEPS))
"""The same about values that are already good."""
WIDTHS = (8.0, 16.0)
"""Standard deviations of the steps from these."""
FARTHEST = 0.3
"""Longest of these steps, relative to the values."""
TOLD = 2.0 / FARTHEST**2
"""Inverse of a relative variance above which recordings tell anything: what they do not stays where the user gave it."""


def reidentify(workshop: Workshop, misfit: Misfit, everywhere: bool = True) -> Search:
    """The best fit of the model as it is; what then remains, no tuning of its parameters removes.

    A model has many local optima where thresholds are crossed. Where taking in the recordings little by little leaves
    something, another search begins at many starts about the values, and where that does not meet the first, the workshop's
    finder looks everywhere. Where it leaves nothing, a better optimum about there would yet look like a small effect.

    Arguments:
        everywhere: whether what is left is worth more searches: no numbers explain instruments that contradict each other.
    """
    near = understood(workshop, misfit)
    if not everywhere:
        return weighed([near])[0]
    if explains(near):
        return refine(workshop.identifier, near.fitted())
    searches = [near, _fitted(workshop, misfit, [_best_of_many(workshop.identifier, misfit)])]
    if not meet([search.state.cost for search in searches]):
        searches.append(_fitted(workshop, misfit, [_found(workshop.finder, misfit)]))
    return weighed([min(searches, key=lambda search: search.state.cost)])[0]


def understood(workshop: Workshop, misfit: Misfit) -> Search:
    """The best fit that is come to little by little, from the misfit's own values and where the equations of motion lead."""

    def ends(is_led: bool) -> list[Mapping[str, float]]:
        if not is_led:
            return [grown(workshop.identifier, misfit)]
        end = regression(workshop, misfit)
        return [] if end is None else [grown(workshop.identifier, misfit.with_values(end[0])), end[0]]

    led, own = spread(ends, [True, False])  # first what takes longer
    best = _fitted(workshop, misfit, [*own, *led])
    return best if explains(best) else begun_from_given(wakened(workshop, best), misfit)


def _fitted(workshop: Workshop, misfit: Misfit, ends: Sequence[Mapping[str, float]]) -> Search:
    """The best fit from these values."""
    searches = advance_all(begin_all(workshop.identifier, [misfit.with_values(end) for end in ends]), STEPS)
    return min(searches, key=lambda search: search.state.cost)


def _found(finder: Identifier[Any], misfit: Misfit) -> Mapping[str, float]:
    state = advanced(finder, misfit, finder.start(misfit), FINDING)
    return misfit.values(np.asarray(state.point))


def refine(identifier: Identifier[Any], misfit: Misfit) -> Search:
    """The fit from values that are already good, and from others about them: a better optimum may be near.

    Where they are not, as beside a run that they were not fitted to, the covariance there says little of where it may be.
    """
    about = scattered_by_deviation if begin(identifier, misfit).normalised < UNEXPLAINED else scattered
    searches = begin_all(identifier, about(misfit, REFINING[0][0]))
    for size, steps in REFINING:
        searches = advance_all(sorted(searches, key=lambda search: search.deviance)[:size], steps)
    return min(searches, key=lambda search: search.deviance)


def _best_of_many(identifier: Identifier[Any], misfit: Misfit) -> Mapping[str, float]:
    """Where the best of several searches ends that begin at the model's values and around them."""
    searches = begin_all(identifier, scattered(misfit, HEATS[0][0]))
    for size, steps in HEATS:
        searches = advance_all(sorted(searches, key=lambda search: search.state.cost)[:size], steps)
    best = min(searches, key=lambda search: search.state.cost)
    return best.values


def scattered_by_deviation(misfit: Misfit, count: int) -> list[Misfit]:
    """The misfit at its model's values, and at others the further about them the less the recordings tell; the same each time.

    Steps are of some standard deviations along each axis of the parameters' covariance: optima that leave about as little lie
    there. What the recordings tell nothing of does not move: from everywhere it would leave the same. Starts that are
    scattered alike in all directions leave far more, and lead elsewhere; they are what there is where no covariance is known.
    """
    start, (lower, upper) = misfit.start(), misfit.bounds()
    here = tangent(misfit, start)
    if here is None:
        return scattered(misfit, count)
    relative = np.abs(misfit.parameters(start)) / misfit.scaling(start)
    information, axes = np.linalg.eigh(here.square.curvature * np.outer(relative, relative))
    deviations = np.where(information > TOLD, 1.0 / np.sqrt(np.maximum(information, TOLD)), 0.0)
    random = np.random.default_rng(0).normal(0.0, 1.0, (count - 1, len(start)))
    widths = np.resize(WIDTHS, count - 1)[:, None]
    moves = np.minimum(widths * deviations, FARTHEST) * random @ axes.T
    points = [start, *(np.clip(start + move * relative, lower, upper) for move in moves)]
    return [misfit.with_values(misfit.values(point)) for point in points]


def scattered(misfit: Misfit, count: int) -> list[Misfit]:
    """The misfit at its model's values, and at others scattered about them within the bounds; the same each time."""
    start, (lower, upper) = misfit.start(), misfit.bounds()
    relative = np.abs(misfit.parameters(start)) / misfit.scaling(start)
    scatter = np.random.default_rng(0).normal(0.0, SCATTER, (count - 1, len(start)))
    points = [start, *(np.clip(start + move * relative, lower, upper) for move in scatter)]
    return [misfit.with_values(misfit.values(point)) for point in points]
