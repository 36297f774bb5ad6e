"""Smoothing splines on as few knots as show all that the samples tell."""

from collections.abc import Callable

import numpy as np
from attrs import evolve, frozen
from numpy.polynomial import Polynomial

from crashkit_smoothers.choice import Score, best_fit
from crashkit_smoothers.knots import knot_vector
from crashkit_smoothers.local_stiffness import local_stiffness
from crashkit_smoothers.penalised_spline import Fit, PenalisedSpline
from crashkit_smoothers.reading import Reading

FIRST_KNOTS = 100
"""The condition grows with a power of knots over degrees of freedom: knots at each of 1e4 samples of a smooth motion lose all digits."""
FINER = 3
ENOUGH = 1000
"""Samples that a trend needs: the spline takes up what it leaves."""
WORTH = 0.05
"""Of what the degrees of freedom cost, that finer knots must gain to be kept."""
WHITE = 0.05
"""Correlation of neighbouring residuals, at the most, where nothing is left that finer knots could show."""


@frozen
class Recipe:
    """How to smooth.

    Attributes:
        order: q of the derivative that is penalised.
        score: what chooses the smoothing.
        local: whether the stiffness follows the motion's own roughness.
        contacts: in ]0, 1[, where the second derivative may jump.
    """

    order: int
    score: Score
    local: bool = False
    contacts: tuple[float, ...] = ()


@frozen
class SplineFit:
    """A smoothing spline with the smoothing that its recipe chose."""

    spline: PenalisedSpline
    fit: Fit
    score: float
    trend: Polynomial
    contacts: tuple[float, ...]

    def evaluated(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value, first and second derivative at sorted x, and their standard deviations at scaled noise 1: both (3, len(x))."""
        values, spreads = self.spline.evaluated(x, self.fit)
        return values + np.stack([self.trend.deriv(order)(x) for order in range(3)]), spreads


def fit_spline(reading: Reading, recipe: Recipe) -> SplineFit:
    """The spline that a recipe makes of the samples.

    A polynomial that costs no roughness is taken off first and added again, which keeps it out of the rounding.
    """
    x = reading.x[reading.present]
    few = slice(None, None, 1 + len(x) // ENOUGH)
    trend = Polynomial.fit(x[few], reading.z[few], recipe.order - 1, domain=[0.0, 1.0])
    rest = reading.z - trend(x)

    def on(interior: int, near: float | None) -> SplineFit:
        knots = knot_vector(x, interior, 2 * recipe.order - 1, recipe.contacts)
        spline = PenalisedSpline.of(x, rest, reading.scale, knots, recipe.order, reading.rounding)
        return SplineFit(spline, *best_fit(spline, reading.count, recipe.score, near), trend, recipe.contacts)

    uniform = _on_enough_knots(on, reading)
    if not recipe.local:
        return uniform
    spline = evolve(uniform.spline, stiffness=local_stiffness(uniform.spline, uniform.fit))
    return SplineFit(spline, *best_fit(spline, reading.count, recipe.score, uniform.fit.smoothing), trend, recipe.contacts)


def _on_enough_knots(on: Callable[[int, float | None], SplineFit], reading: Reading) -> SplineFit:
    """The fit on the fewest knots to which finer ones add nothing.

    Finer knots are kept where they earn more than a small part of what the degrees of freedom cost. Where they do not and yet
    the residuals are no white noise, the signal may be too fast for both, and still finer knots are tried.
    """
    most = max(int(reading.count) - 2, 1)
    interior = min(FIRST_KNOTS, most)
    best = on(interior, None)
    while interior < most:
        interior = min(FINER * interior, most)
        finer = on(interior, best.fit.smoothing)
        if best.score - finer.score > WORTH * finer.fit.freedom:
            best = finer
        elif _is_white(best, reading):
            break
    return best


def _is_white(fitted: SplineFit, reading: Reading) -> bool:
    x = reading.x[reading.present]
    values, _ = fitted.spline.evaluated(x, fitted.fit, 1)
    residual = (reading.z - fitted.trend(x) - values[0]) * reading.scale
    return float(residual[1:] @ residual[:-1]) <= WHITE * float(residual @ residual)
