"""Instants at which the acceleration jumps, as where a contact begins or ends: room for them, and how they are found."""

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np
from attrs import evolve
from scipy.optimize import minimize_scalar
from scipy.signal import find_peaks

from crashkit_smoothers.reading import Reading
from crashkit_smoothers.smoothing_spline import Recipe, SplineFit, fit_spline

MOST = 4
"""Contacts that are looked for."""
PRICE = 8.0
"""Deviance that a contact must earn: of 136 draws of smooth pulses one earned more, 8.1."""
TRIED = 3
"""Peaks of the rate of acceleration that are tried for each contact."""
WIDEST = 0.05
"""Of the duration, the reach of a search about a peak."""
PRECISION = 0.02
"""Of that reach."""
PROHIBITIVE = 1e300
"""The score of contacts without room between them; a search cannot reckon with infinity."""


def has_room(x: np.ndarray, contacts: tuple[float, ...], order: int) -> bool:
    """Whether there are `order` samples before, between and after the contacts."""
    edges = np.searchsorted(x, [-np.inf, *contacts, np.inf])
    return all(after - before >= order for before, after in pairwise(edges))


def fit_with_contacts_found(reading: Reading, recipe: Recipe) -> SplineFit:
    """The spline with the recipe's contacts and with those that the samples show.

    One is found after the other, and as many are kept as earn their price together: while one jump is still to be followed
    closely the smoothing cannot grow, so that another earns little by itself. The stiffness is uniform meanwhile.
    """
    found = [fit_spline(reading, evolve(recipe, local=False))]
    while len(found) <= MOST:
        tried = _with_one_more(reading, recipe, found[-1])
        if tried is None:
            break
        found.append(tried)
    best = min(found, key=lambda fitted: fitted.score + PRICE * len(fitted.contacts))
    return fit_spline(reading, evolve(recipe, contacts=best.contacts))


def _with_one_more(reading: Reading, recipe: Recipe, best: SplineFit) -> SplineFit | None:
    """The best of the fits with one more contact, all that were found settled; None where there is no room for it."""
    x = reading.x[reading.present]
    reach = min(1.0 / best.fit.freedom, WIDEST)

    def with_contacts(*found: float) -> Recipe:
        return evolve(recipe, contacts=tuple(sorted((*recipe.contacts, *found))), local=False)

    def score(*found: float) -> float:
        tried = with_contacts(*found)
        return fit_spline(reading, tried, best).score if has_room(x, tried.contacts, recipe.order) else PROHIBITIVE

    found = tuple(contact for contact in best.contacts if contact not in recipe.contacts)
    peaks = _peaks(best, reach)
    if not peaks:
        return None
    found = (min(peaks, key=lambda peak: score(peak, *found)), *found)
    for _ in found:
        place, *others = found
        found = (*others, _settled(partial(score, *others), place, reach))
    chosen = with_contacts(*found)
    return fit_spline(reading, chosen, best) if has_room(x, chosen.contacts, recipe.order) else None


def _settled(score: Callable[[float], float], place: float, reach: float) -> float:
    """Where the score is least near a place."""
    bounds = (place - 0.5 * reach, place + 0.5 * reach)
    return float(minimize_scalar(score, bounds=bounds, method="bounded", options={"xatol": PRECISION * reach}).x)


def _peaks(best: SplineFit, reach: float) -> list[float]:
    """Where the penalised derivative is largest, largest first, neither near an end nor near a contact.

    A smoothed jump is a peak of the next derivative, as wide as one degree of freedom.
    """
    degree = 2 * best.spline.order - 1
    edges = best.spline.knots[degree : len(best.spline.knots) - degree]
    roughness = best.spline.roughness_of(best.fit)
    middle = 0.5 * (edges[1:] + edges[:-1])
    peaks, _ = find_peaks(roughness)
    taken = np.array([0.0, *best.contacts, 1.0])
    free = [peak for peak in peaks if np.abs(middle[peak] - taken).min() > reach]
    return middle[sorted(free, key=lambda peak: -roughness[peak])[:TRIED]].tolist()
