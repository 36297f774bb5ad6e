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
"""Deviance that a contact must earn: in 70 draws of smooth pulses none earned more than 6.5."""
TRIED = 3
"""Peaks of the rate of acceleration that are tried for each contact."""
WIDEST = 0.05
"""Of the duration, the reach of a search about a peak."""
PRECISION = 0.02
"""Of that reach."""


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
    """The best of the fits with one more contact, all of them settled; None where there is no room for it."""
    order = recipe.order
    x = reading.x[reading.present]
    reach = min(1.0 / best.fit.freedom, WIDEST)

    def fitted(contacts: tuple[float, ...]) -> SplineFit:
        return fit_spline(reading, evolve(recipe, contacts=tuple(sorted(contacts)), local=False), best)

    def score(contacts: tuple[float, ...]) -> float:
        return fitted(contacts).score if has_room(x, tuple(sorted(contacts)), order) else np.inf

    peaks = [peak for peak in _peaks(best, reach) if has_room(x, tuple(sorted((*best.contacts, peak))), order)]
    if not peaks:
        return None
    contacts = (min(peaks, key=lambda peak: score((*best.contacts, peak))), *best.contacts)
    for _ in contacts:
        place, *others = contacts
        bounds = (place - 0.5 * reach, place + 0.5 * reach)
        moved = partial(_moved, score, tuple(others))
        settled = minimize_scalar(moved, bounds=bounds, method="bounded", options={"xatol": PRECISION * reach})
        contacts = (*others, float(settled.x) if settled.fun < np.inf else place)
    return fitted(contacts)


def _moved(score: Callable[[tuple[float, ...]], float], others: tuple[float, ...], place: float) -> float:
    return score((place, *others))


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
