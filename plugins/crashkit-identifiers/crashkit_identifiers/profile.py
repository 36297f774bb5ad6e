"""Intervals by profile likelihood, where curvature misleads: a threshold may be known from one side only."""

from collections.abc import Sequence

import numpy as np
from attrs import evolve, frozen

from crashkit.errors import SimulationError
from crashkit.misfit import SameVariables
from crashkit.protocols import Problem
from crashkit_identifiers.cost import cost_at, half_square, residual_at
from crashkit_identifiers.levenberg_marquardt import Search, damped_step, promise
from crashkit_identifiers.parabola import Parabola

TRUSTED = 0.3
"""How far the rise of the misfit at the end of a linear interval may be from what is expected, as a share of it."""
CLOSE = (0.9, 1.2)
"""Share of the rise that is as good as the rise: an end is then known to 5 % of the half width inside, and 10 % outside."""
TRIALS = 10
STRIDE = (0.2, 2.0)
"""How much further the next trial may be, as a share of the last."""
STEEP, NEARLY = 0.1, 0.9
"""Where, between two that enclose the end, the next trial may be."""
LOOSE = 25.0
"""Excess of χ² beyond which a profile says no more than the curvature."""
OPEN = 1e3
"""Times a value: an interval that reaches as far has no end."""
ENOUGH = 0.05
"""Of the rise: a drop that is no longer worth a step."""
HELPS = 0.25
"""Share of a promised drop that a step must keep."""
REFITS, CHORDS = 3, 4
"""Jacobians of a refit, and steps with each."""
DAMPING, DAMPED = 1e-6, 100.0
"""The first, and what it is multiplied by when a step does not help."""


def intervals(problem: Problem, found: Parabola) -> np.ndarray:
    """Both ends (2, parameter) of the 95 % interval of every search variable.

    All values whose misfit, with every other variable at its best, is no larger than at the point found by more than chance
    allows (Venzon & Moolgavkar 1988, doi:10.2307/2347496). The curvature gives the ends where the misfit agrees with it; a
    bound is an end where the recordings set none, and where the point is too far from the least misfit to tell.
    """
    bounds, point, reach = np.array(problem.bounds()), found.point, found.reach()
    if found.is_far:
        return bounds
    centre = point + found.left
    linear = np.clip(np.array([np.minimum(centre - reach, point), np.maximum(centre + reach, point)]), *bounds)
    linear[:, found.held] = bounds[:, found.held]
    if found.excess > LOOSE:
        return linear
    profile = Profile(problem, found)
    free = np.flatnonzero(~found.held).tolist()
    for side in (0, 1):
        linear[side, free] = [profile.end(index, float(linear[side, index]), float(bounds[side, index])) for index in free]
    return linear


class Profile:
    """The least misfit over all variables but one, as a function of that one.

    Arguments:
        problem: whose misfit it is.
        found: its parabola about the point found.
    """

    def __init__(self, problem: Problem, found: Parabola) -> None:
        self.problem, self.found = problem, found
        self._bounds = problem.bounds()
        is_logarithm = problem.scaling(found.point) != 1.0
        self._size = np.where(is_logarithm, 1.0, np.maximum(1.0, np.abs(found.point)))
        self._furthest = self._size * np.where(is_logarithm, np.log(OPEN), OPEN)
        self._slopes = _slopes(found, self._size)

    def end(self, index: int, linear: float, bound: float) -> float:
        """The end of an interval towards a bound: `linear` if the misfit rises there as the curvature expects."""
        start, rise = float(self.found.point[index]), self.found.rise
        limit = start + float(np.clip(bound - start, -self._furthest[index], self._furthest[index]))
        if linear != bound and abs(linear - start) < abs(limit - start) and self._agrees(index, linear):
            return linear
        first = start + float(np.copysign(self._size[index], limit - start))
        trial = min(linear, first, limit, key=lambda value: abs(value - start))
        inside, outside, refit = [(start, 0.0)], None, None
        for _ in range(TRIALS):
            refit = self._refitted(index, trial, refit)
            if CLOSE[0] * rise <= refit.rise <= CLOSE[1] * rise:
                return trial
            if refit.rise < rise and trial == limit:
                return bound
            if refit.rise < rise:
                inside.append((trial, refit.rise))
            else:
                outside = (trial, refit.rise)
            trial = _between(inside[-1], outside, rise) if outside else _beyond(inside, rise, limit)
        # A misfit that never rose, ever further out, sets no end.
        return bound if outside is None else outside[0]

    def _agrees(self, index: int, end: float) -> bool:
        """Whether the misfit rises as the curvature expects."""
        risen = cost_at(self.problem, self._ridge(index, end)) - self.found.cost
        return abs(risen - self.found.expected(index, end)) < TRUSTED * self.found.rise

    def _ridge(self, index: int, value: float) -> np.ndarray:
        """Where the curvature expects the others when one variable has that value."""
        centre = self.found.point + self.found.left
        return self._at(index, value, centre + (value - centre[index]) * self._slopes[:, index])

    def _at(self, index: int, value: float, point: np.ndarray) -> np.ndarray:
        """A point within the bounds, with that value of one variable."""
        point = np.clip(point, *self._bounds)
        point[index] = value
        return point

    def _refitted(self, index: int, value: float, last: "_Refit | None") -> "_Refit":
        """The least misfit with one variable held, as far as it matters, from where the last refit or the curvature leads."""
        own = self.found.point
        starts = [self._at(index, value, own), self._ridge(index, value)]
        if last is not None:
            further = (value - own[index]) / (last.point[index] - own[index])
            starts[1] = self._at(index, value, own + further * (last.point - own))
        costs = [cost_at(self.problem, start) for start in starts]
        best = int(np.argmin(costs))
        refit = _Refit(starts[best], costs[best] - self.found.cost)
        for _ in range(REFITS):
            if refit.is_settled or refit.rise < CLOSE[0] * self.found.rise:
                break
            refit = self._followed(index, refit)
        return refit

    def _followed(self, index: int, refit: "_Refit") -> "_Refit":
        """The others after Gauss-Newton steps, all with the derivatives at the first point, as long as they help."""
        held = _Held(self.problem, index, float(refit.point[index]))
        point, damping, enough = refit.point, DAMPING, ENOUGH * self.found.rise
        try:
            with np.errstate(over="ignore", invalid="ignore"):  # refused below, which is no reason to warn
                residual, jacobian = self.problem.residual_and_jacobian(point)
                curvature, cost = jacobian.T @ jacobian, self.found.cost + refit.rise
        except SimulationError:
            return evolve(refit, is_settled=True)
        if not np.isfinite(curvature).all():
            return evolve(refit, is_settled=True)
        for _ in range(CHORDS):
            search = Search(point, cost, jacobian.T @ residual, curvature, damping)
            move = damped_step(held, search, 1.0)
            if promise(search, move) < enough:
                break
            there = residual_at(self.problem, point + move)
            gained = cost - half_square(there)
            if gained > HELPS * promise(search, move):
                point, residual, cost = point + move, there, cost - gained
            else:
                damping *= DAMPED
        rise = cost - self.found.cost
        return _Refit(point, rise, refit.rise - rise < enough)


@frozen(eq=False)
class _Refit:
    """Where the others are with one variable held, how far the cost is above the least, and whether it falls no further."""

    point: np.ndarray
    rise: float
    is_settled: bool = False


class _Held(SameVariables):
    """The problem with one variable held."""

    def __init__(self, problem: Problem, index: int, value: float) -> None:
        super().__init__(problem)
        self.index, self.value = index, value

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        lower, upper = (bound.copy() for bound in self.problem.bounds())
        lower[self.index] = upper[self.index] = self.value
        return lower, upper

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.problem.residual_and_jacobian(scaled)


def _slopes(found: Parabola, size: np.ndarray) -> np.ndarray:
    """How far each variable (row) follows each other one (column) along the bottom of the parabola.

    What the readings do not see would follow anywhere: it is kept to about its own size.
    """
    slopes, free = np.eye(len(size)), np.flatnonzero(~found.held)
    inner = np.linalg.inv(found.curvature[np.ix_(free, free)] + np.diag(1.0 / size[free] ** 2))
    slopes[np.ix_(free, free)] = inner / np.diag(inner)
    return slopes


def _between(inside: tuple[float, float], outside: tuple[float, float], rise: float) -> float:
    """Where the cost should have risen by `rise`, if it rises as a square; half way where it rises much more steeply."""
    low, wanted, high = np.sqrt(np.maximum([inside[1], rise, outside[1]], 0.0))
    share = float((wanted - low) / (high - low))
    return inside[0] + (min(share, NEARLY) if share > STEEP else 0.5) * (outside[0] - inside[0])


def _beyond(inside: Sequence[tuple[float, float]], rise: float, limit: float) -> float:
    """The same beyond all that was tried, three times as far at most."""
    (start, _), (before, lower), (last, low) = inside[0], inside[-2], inside[-1]
    lower, low, wanted = np.sqrt(np.maximum([lower, low, rise], 0.0))
    ahead = (wanted - low) / max(low - lower, 1e-3 * wanted) * (last - before)
    further = last + float(np.clip(ahead / (last - start), *STRIDE)) * (last - start)
    return further if abs(further - start) < abs(limit - start) else limit
