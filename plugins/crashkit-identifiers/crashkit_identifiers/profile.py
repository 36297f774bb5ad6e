"""Intervals by profile likelihood, where curvature misleads: a threshold may be known from one side only."""

from collections.abc import Sequence

import numpy as np
from attrs import evolve, frozen

from crashkit.campaign import spread
from crashkit.errors import SimulationError
from crashkit.misfit import SameVariables
from crashkit.protocols import Problem
from crashkit_identifiers.cost import cost_at, half_square, residual_at, unwarned
from crashkit_identifiers.levenberg_marquardt import Search, damped_step, promise
from crashkit_identifiers.parabola import Parabola

TRUSTED = 0.3
"""How far the rise of the misfit at the end of a linear interval may be from what is expected, as a share of it."""
CLOSE = (0.9, 1.2)
"""Share of the rise that is as good as the rise: an end is then known to 5 % of the half width inside, and 10 % outside."""
TRIALS = 12
STRIDE = (0.2, 2.0)
"""How much further the next trial may be, as a share of the last."""
STEEP, NEARLY = 0.1, 0.9
"""Where, between two that enclose the end, the next trial may be."""
LOOSE = 25.0
"""Excess of χ² beyond which a profile says no more than the curvature."""
NARROW = 0.05
"""Of the way behind and ahead: where the misfit leaps between two trials that close, there is a cliff."""
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
    bound is an end where the recordings set none, where no end was reached, and where the point is too far from the least
    misfit to tell.
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
    sought = [(index, linear[side, index], bounds[side, index]) for index in range(len(point)) for side in range(2)]
    return np.array(spread(lambda end: profile.end(*end), sought)).reshape(-1, 2).T


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
        start, size = float(self.found.point[index]), float(self._size[index])
        limit = start + float(np.clip(bound - start, -self._furthest[index], self._furthest[index]))
        if limit == start:
            return bound
        if linear != bound and abs(linear - start) < abs(limit - start) and self._agrees(index, linear):
            return linear
        most = min(size, self.found.alone[index]) if self.found.held[index] else size
        first = start + float(np.copysign(most, limit - start))
        return self._sought(index, min(linear, first, limit, key=lambda value: abs(value - start)), limit, bound)

    def _sought(self, index: int, trial: float, limit: float, bound: float) -> float:
        """The end, followed from trial to trial along the valley that the others make; the bound where none is reached."""
        rise, inside, outside = self.found.rise, [_Refit(self.found.point, 0.0)], None
        for _ in range(TRIALS):
            refit = self._refitted(index, trial, inside[-1])
            if refit.is_settled and CLOSE[0] * rise <= refit.rise <= CLOSE[1] * rise:
                return trial
            if refit.rise >= rise:
                outside = refit
            elif trial == limit:
                return bound
            else:
                inside.append(refit)
                # What was given up from further away proves nothing from here.
                outside = outside if outside and outside.is_settled else None
            trial = self._next(index, inside, outside, limit, refit is not outside)
        return float(outside.point[index]) if outside and self._is_cliff(index, inside[-1], outside, bound) else bound

    def _next(self, index: int, trials: Sequence["_Refit"], outside: "_Refit | None", limit: float, fell_short: bool) -> float:
        """The next trial: between the last inside and one outside, or beyond."""
        inside = [(float(one.point[index]), one.rise) for one in trials]
        if outside is None:
            return _beyond(inside, self.found.rise, limit)
        return _between(inside[-1], (float(outside.point[index]), outside.rise), self.found.rise, fell_short)

    def _is_cliff(self, index: int, inside: "_Refit", outside: "_Refit", bound: float) -> bool:
        """Whether the misfit is too high even from a trial inside that is so close that the others cannot have gone astray."""
        value = float(outside.point[index])
        way = min(abs(value - self.found.point[index]), abs(bound - value))
        is_close = abs(value - inside.point[index]) < NARROW * way
        return is_close and self._refitted(index, value, inside).rise >= self.found.rise

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

    def _refitted(self, index: int, value: float, last: "_Refit") -> "_Refit":
        """The least misfit with one variable held, as far as it matters, from where the last refit or the curvature leads."""
        own = self.found.point
        starts = [self._at(index, value, own), self._ridge(index, value)]
        if last.point[index] != own[index]:
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
            with unwarned():
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


def _between(inside: tuple[float, float], outside: tuple[float, float], rise: float, fell_short: bool) -> float:
    """Where the cost should have risen by `rise`, if it rises as a square.

    At least half way where it rises much more steeply, or where the last trial between them fell short.
    """
    low, wanted, high = np.sqrt(np.maximum([inside[1], rise, outside[1]], 0.0))
    share = float((wanted - low) / (high - low))
    least = 0.5 if fell_short or share <= STEEP else share
    return inside[0] + float(np.clip(share, least, NEARLY)) * (outside[0] - inside[0])


def _beyond(inside: Sequence[tuple[float, float]], rise: float, limit: float) -> float:
    """The same beyond all that was tried, three times as far at most."""
    (start, _), (before, lower), (last, low) = inside[0], inside[-2], inside[-1]
    lower, low, wanted = np.sqrt(np.maximum([lower, low, rise], 0.0))
    ahead = (wanted - low) / max(low - lower, 1e-3 * wanted) * (last - before)
    further = last + float(np.clip(ahead / (last - start), *STRIDE)) * (last - start)
    return further if abs(further - start) < abs(limit - start) else limit
