"""Smoothing splines on as few knots as show all that the samples tell."""

import numpy as np
from attrs import evolve, frozen
from numpy.polynomial import Polynomial

from crashkit_smoothers.choice import Score, best_fit
from crashkit_smoothers.knots import knot_vector
from crashkit_smoothers.local_stiffness import local_stiffness
from crashkit_smoothers.penalised_spline import Fit, PenalisedSpline
from crashkit_smoothers.reading import Reading

FIRST_KNOTS = 100
"""The condition grows with a power of knots over freedom: knots at all of 1e4 samples of a smooth motion lose all digits."""
FINER = 3
WORTH = 0.05
"""Of the degrees of freedom, what finer knots must earn in deviance to be kept."""
WHITE = 0.05
"""Correlation of neighbouring residuals, at the most, where nothing is left that finer knots could show."""
ENOUGH = 1000
"""Samples that a trend needs: the spline takes up what it leaves."""


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
    """A smoothing spline with the smoothing that its recipe chose.

    Attributes:
        spline, fit: of what the trend leaves.
        score: of that smoothing.
        trend: a polynomial that costs no roughness, taken off first and added again, which keeps it out of the rounding.
        contacts: of the recipe.
        interior: knots within ]0, 1[ that were allowed.
    """

    spline: PenalisedSpline
    fit: Fit
    score: float
    trend: Polynomial
    contacts: tuple[float, ...]
    interior: int

    def evaluated(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value, first and second derivative at sorted x, and their standard deviations at scaled noise 1: (3, len(x))."""
        values, spreads = self.spline.evaluated(x, self.fit)
        for order in range(3):
            values[order] += self.trend.deriv(order)(x)
        return values, spreads


def fit_spline(reading: Reading, recipe: Recipe, like: SplineFit | None = None) -> SplineFit:
    """The spline that a recipe makes of the samples; with as many knots as another, and a smoothing near its own, if given."""
    workpiece = _Workpiece.of(reading, recipe)
    uniform = workpiece.on_knots(like.interior, like.fit.smoothing) if like else _on_enough_knots(workpiece)
    if not recipe.local:
        return uniform
    spline = evolve(uniform.spline, stiffness=local_stiffness(uniform.spline, uniform.fit))
    return workpiece.fitted(spline, uniform.interior, uniform.fit.smoothing)


@frozen
class _Workpiece:
    """Samples without their trend, and the recipe."""

    reading: Reading
    recipe: Recipe
    x: np.ndarray
    rest: np.ndarray
    trend: Polynomial

    @classmethod
    def of(cls, reading: Reading, recipe: Recipe) -> "_Workpiece":
        x = reading.x[reading.present]
        few = slice(None, None, 1 + len(x) // ENOUGH)
        trend = Polynomial.fit(x[few], reading.z[few], recipe.order - 1, domain=[0.0, 1.0], w=reading.scale[few])
        return cls(reading, recipe, x, reading.z - trend(x), trend)

    def on_knots(self, interior: int, near: float | None) -> SplineFit:
        """The fit on so many knots, with a smoothing near one that is known."""
        order, reading = self.recipe.order, self.reading
        knots = knot_vector(self.x, interior, 2 * order - 1, self.recipe.contacts)
        spline = PenalisedSpline.of(self.x, self.rest, reading.scale, knots, order, reading.rounding)
        return self.fitted(spline, interior, near)

    def fitted(self, spline: PenalisedSpline, interior: int, near: float | None) -> SplineFit:
        """The spline with the best smoothing."""
        fit, score = best_fit(spline, self.reading.count, self.recipe.score, near)
        return SplineFit(spline, fit, score, self.trend, self.recipe.contacts, interior)

    def is_explained(self, fitted: SplineFit) -> bool:
        """Whether the residuals are white noise."""
        residual = fitted.spline.evaluated(self.x, fitted.fit, 1)[0][0]
        residual -= self.rest
        residual *= self.reading.scale
        return bool(np.sum(residual[1:] * residual[:-1]) <= WHITE * np.sum(residual**2))


def _on_enough_knots(workpiece: _Workpiece) -> SplineFit:
    """The fit on the fewest knots to which finer ones add nothing.

    Finer knots are kept where they earn more than a small part of what the degrees of freedom cost. Where they do not and yet
    the residuals are no white noise, the signal may be too fast for both, and still finer knots are tried.
    """
    most = max(int(workpiece.reading.count) - 2, 1)
    interior = min(FIRST_KNOTS, most)
    best = workpiece.on_knots(interior, None)
    while interior < most:
        interior = min(FINER * interior, most)
        finer = workpiece.on_knots(interior, best.fit.smoothing)
        if best.score - finer.score > WORTH * finer.fit.freedom:
            best = finer
        elif workpiece.is_explained(best):
            break
    return best
