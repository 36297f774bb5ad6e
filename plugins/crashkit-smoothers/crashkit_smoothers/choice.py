"""How much to smooth: scores, each less for a better fit, and the search for the least.

A score is in units of a deviance: a difference of 2 is what one more degree of freedom must earn.
"""

from collections.abc import Callable
from functools import cache, partial

import numpy as np
from attrs import frozen

from crashkit_smoothers.penalised_spline import Fit, PenalisedSpline

Score = Callable[[float, float, float], float]
"""From the number of independent samples, the residual sum of squares and the degrees of freedom."""

PRICE = 0.7
"""Of a degree of freedom, what robust scores ask above the usual 2: more rounds peaks off, less follows the noise at times."""
MOST_FREEDOM = 0.9
"""Of the samples: with as much freedom as samples the score is 0 / 0."""
CONDITION = {2: 1e20, 3: 1e14, 4: 1e11}
"""By the order that is penalised, the largest smoothing over that which holds the roughest wave half back.

Up to it degrees of freedom and standard deviations keep three digits; what is smoother needs fewer knots.
"""
STEP = 0.8
"""Decades between the candidates over the whole range."""
NEAR = 2.5
"""Decades to either side of a smoothing that is known to be near."""
NARROWED = 10
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


def cross_validation(count: float, residual: float, freedom: float) -> float:
    """Generalised cross-validation, n ln V of V = n |(I - A) z|^2 / tr(I - A)^2.

    Craven & Wahba 1978, doi:10.1007/BF01404567; Mizzi & Jezequel 1992, eq 32.
    """
    return count * float(np.log(max(count * residual, np.finfo(float).tiny) / (count - freedom) ** 2))


def robust_cross_validation(count: float, residual: float, freedom: float) -> float:
    """The same, n ln V (1 + 0.7 tr A / n): one time in ten V alone is least at a curve that follows the noise.

    Lukas 2006, doi:10.1088/0266-5611/22/5/021, with 1 / 1.7 for his gamma and A in place of A^2.
    """
    return cross_validation(count, residual, freedom) + count * float(np.log1p(PRICE * freedom / count))


def unbiased_risk(count: float, residual: float, freedom: float) -> float:
    """The unbiased risk for noise of standard deviation 1, |(I - A) z|^2 + 2 tr A.

    Mallows 1973, doi:10.1080/00401706.1973.10489103.
    """
    return residual + 2.0 * freedom


def robust_unbiased_risk(count: float, residual: float, freedom: float) -> float:
    """The same with the price of freedom that robust cross-validation has, |(I - A) z|^2 + 2.7 tr A."""
    return residual + (2.0 + PRICE) * freedom


@frozen
class Criterion:
    """What chooses the smoothing: one score where the noise is to be found, another where it is known.

    Attributes:
        words: the first, as people call it.
        unknown, known: the scores.
    """

    words: str
    unknown: Score
    known: Score


CROSS_VALIDATION = Criterion("generalised cross-validation", cross_validation, unbiased_risk)
ROBUST_CROSS_VALIDATION = Criterion("robust cross-validation", robust_cross_validation, robust_unbiased_risk)


def best_fit(spline: PenalisedSpline, count: float, score: Score, near: float | None = None) -> tuple[Fit, float]:
    """The fit whose smoothing has the least score, and that score.

    On [0, 1] the roughness of k half waves is (pi k)^2q / 2 times their square: the candidates reach from the smoothing that
    leaves the roughest wave to the one that leaves none. A score may have several valleys, so the whole range is looked at,
    unless it is known which smoothing the best one is near.
    """
    waves, size = 2 * spline.order, float(len(spline.right))
    least = np.log10(0.1 * spline.mass) - waves * np.log10(np.pi * size)
    none_left = np.log10(1e3 * spline.mass) - waves * np.log10(np.pi)
    most = min(none_left, np.log10(CONDITION[spline.order] * spline.mass) - waves * np.log10(size))
    candidates = np.linspace(most, least, int((most - least) / STEP) + 2)  # of equals the smoothest is best
    tried = cache(partial(_tried, spline, count, score))
    if near is not None:
        close = candidates[np.abs(candidates - np.log10(near)) < NEAR]
        if len(close) and 0 < np.argmin([tried(candidate) for candidate in close]) < len(close) - 1:
            candidates = close
    best = int(np.argmin([tried(candidate) for candidate in candidates]))
    chosen = _golden(tried, candidates[min(best + 1, len(candidates) - 1)], candidates[max(best - 1, 0)])
    return spline.with_smoothing(10.0**chosen), tried(chosen)


def _tried(spline: PenalisedSpline, count: float, score: Score, logarithm: float) -> float:
    fit = spline.with_smoothing(10.0**logarithm)
    in_range = 0.0 < fit.freedom <= MOST_FREEDOM * count
    return score(count, fit.residual, fit.freedom) if in_range else np.inf


def _golden(tried: Callable[[float], float], low: float, high: float) -> float:
    """Where between two logarithms the score is least, by golden section."""
    left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    for _ in range(NARROWED):
        if tried(left) < tried(right):
            high, right, left = right, left, right - GOLDEN * (right - low)
        else:
            low, left, right = left, right, left + GOLDEN * (high - left)
    return min(right, left, key=tried)
