"""Finds the instants at which the acceleration jumps, as where a contact begins or ends."""

import numpy as np
from attrs import evolve
from scipy.optimize import minimize_scalar
from scipy.signal import find_peaks

from crashkit_smoothers.reading import Reading
from crashkit_smoothers.smoothing_spline import Recipe, SplineFit, fit_spline

MOST = 6
EARNED = 20.0
"""Deviance that a jump must earn: its place was searched for, and a smooth motion must have none."""
TRIED = 3
"""Peaks of the rate of acceleration that are tried for each contact."""
PRECISION = 1e-3


def fit_with_contacts_found(reading: Reading, recipe: Recipe) -> SplineFit:
    """The spline with the recipe's contacts and with those that the samples show, one after the other.

    Each new contact is placed where the score is least, and kept if that is lower by more than chance would have it.
    """
    best = fit_spline(reading, recipe)
    for _ in range(MOST):
        tried = _with_one_more(reading, recipe, best)
        if tried is None or best.score - tried.score < EARNED:
            break
        best = tried
    return best


def _with_one_more(reading: Reading, recipe: Recipe, best: SplineFit) -> SplineFit | None:
    """The best of the fits with one more contact; None where there is no place for it.

    A smoothed jump is a peak of the next derivative, as wide as one degree of freedom.
    """
    reach = 1.0 / best.fit.freedom

    def score(place: float) -> float:
        return _with(reading, recipe, best, place).score

    peaks = _peaks(best, reach)
    if not len(peaks):
        return None
    peak = min(peaks, key=score)
    place = minimize_scalar(score, bounds=(peak - 0.5 * reach, peak + 0.5 * reach), method="bounded", options={"xatol": PRECISION * reach}).x
    return _with(reading, recipe, best, float(place))


def _with(reading: Reading, recipe: Recipe, best: SplineFit, place: float) -> SplineFit:
    return fit_spline(reading, evolve(recipe, contacts=tuple(sorted((*best.contacts, place)))))


def _peaks(best: SplineFit, reach: float) -> np.ndarray:
    """Where the penalised derivative is largest, largest first, neither near an end nor near a contact."""
    order = best.spline.order
    edges = best.spline.knots[2 * order - 1 : len(best.spline.knots) - 2 * order + 1]
    roughness = best.spline.roughness_of(best.fit)
    middle = 0.5 * (edges[1:] + edges[:-1])
    peaks, _ = find_peaks(roughness)
    taken = np.array([0.0, *best.contacts, 1.0])
    free = [peak for peak in peaks if np.abs(middle[peak] - taken).min() > reach]
    return middle[sorted(free, key=lambda peak: -roughness[peak])[:TRIED]]
