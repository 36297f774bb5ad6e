"""Intervals by profile likelihood, where curvature misleads: a threshold may be known from one side only."""

import numpy as np
from attrs import frozen

from crashkit.protocols import Problem
from crashkit_identifiers.cost import cost_at
from crashkit_identifiers.levenberg_marquardt import Limits, solve
from crashkit_identifiers.wrapped import SameVariables

CONFIDENCE = 1.959963984540054
"""Standard deviations to either side of a 95 % interval."""
TRUSTED = 0.3
"""How far the rise of the misfit at the end of a linear interval may be from what is expected, as a share of it."""
CLOSE = 0.1
TRIALS = 8
STRIDE = (0.3, 3.0)
"""How much nearer or further the next trial may be."""
FAR, LOOSE = 25.0, 25.0
"""χ² between a point and the least misfit, and excess of χ², beyond which a profile says no more than the curvature."""
REFIT = Limits(tolerance=1e-3, steps=6)


@frozen(eq=False)
class Found:
    """What a method found, and what the curvature of the misfit says about it.

    Arguments:
        point: in search variables.
        cost: half the sum of squared residuals there.
        left: the step from there to the least misfit.
        spread: covariance of the search variables, H⁻¹ times `excess`.
        excess: χ² over its expectation, where that is more than chance allows; else 1.
        drop: of the cost along `left`, ½ Δᵀ H Δ.
    """

    point: np.ndarray
    cost: float
    left: np.ndarray
    spread: np.ndarray
    excess: float
    drop: float

    @property
    def rise(self) -> float:
        """Of the cost that marks the end of an interval."""
        return 0.5 * CONFIDENCE**2 * self.excess

    @property
    def is_far(self) -> bool:
        """Whether the point is too far from the least misfit for its curvature to tell anything."""
        return 2.0 * self.drop > FAR * self.excess

    def reach(self) -> np.ndarray:
        """Half the width of every linear interval about the least misfit, so that the point lies inside."""
        return np.sqrt(np.diag(self.spread) * (CONFIDENCE**2 + 2.0 * self.drop / self.excess))

    def expected(self, index: int, value: float) -> float:
        """How far the curvature expects the cost to rise where one variable has that value, the others being at their best."""
        away = value - self.point[index] - self.left[index]
        return float(away**2 / (2.0 * self.spread[index, index]) * self.excess - self.drop)


def intervals(problem: Problem, found: Found) -> np.ndarray:
    """Both ends (2, parameter) of the 95 % interval of every search variable.

    All values whose misfit, with every other variable at its best, is no larger than at the point found by more than chance
    allows (Venzon & Moolgavkar 1988, doi:10.2307/2347496). The curvature gives the ends where the misfit agrees with it; a
    bound is an end where the recordings set none, and where the point is too far from the least misfit to tell.
    """
    lower, upper = problem.bounds()
    held = (found.point <= lower) | (found.point >= upper)
    centre, reach = found.point + found.left, found.reach()
    low = np.where(held, lower, np.minimum(np.maximum(lower, centre - reach), found.point))
    high = np.where(held, upper, np.maximum(np.minimum(upper, centre + reach), found.point))
    if found.is_far:
        return np.array([lower, upper])
    if found.excess > LOOSE:
        return np.array([low, high])
    ends = [
        [_end(problem, found, index, end, bound) for index, (end, bound) in enumerate(zip(line, bounds, strict=True))]
        for line, bounds in ((low.tolist(), lower.tolist()), (high.tolist(), upper.tolist()))
    ]
    return np.array(ends).reshape(2, -1)


def _end(problem: Problem, found: Found, index: int, linear: float, bound: float) -> float:
    start = float(found.point[index])
    if start == bound or (linear != bound and _agrees(problem, found, index, linear)):
        return linear
    trial = linear if np.isfinite(linear) else start + float(np.copysign(max(abs(start), 1.0), linear))
    inside, outside = start, None
    for _ in range(TRIALS):
        rise = _profiled(problem, found, index, trial) - found.cost
        if abs(rise - found.rise) < CLOSE * found.rise or (rise < found.rise and trial == bound):
            return trial
        inside, outside = (inside, trial) if rise > found.rise else (trial, outside)
        further = start + (trial - start) * float(np.clip(np.sqrt(found.rise / max(rise, 1e-300)), *STRIDE))
        trial = _next(further, inside, outside, bound)
    # A misfit that never rose, ever further out, sets no end.
    return bound if outside is None else outside


def _agrees(problem: Problem, found: Found, index: int, end: float) -> bool:
    """Whether the misfit rises as the curvature expects."""
    risen = cost_at(problem, _nearby(problem, found, index, end)) - found.cost
    return abs(risen - found.expected(index, end)) < TRUSTED * found.rise


def _next(further: float, inside: float, outside: float | None, bound: float) -> float:
    """Where a parabola through the least misfit would have its end, kept between what is known."""
    if outside is not None:
        return further if min(inside, outside) < further < max(inside, outside) else 0.5 * (inside + outside)
    return further if abs(further - inside) < abs(bound - inside) else bound


def _profiled(problem: Problem, found: Found, index: int, value: float) -> float:
    """The least cost with one variable held."""
    return solve(_Held(problem, index, value, _nearby(problem, found, index, value)), REFIT).cost


def _nearby(problem: Problem, found: Found, index: int, value: float) -> np.ndarray:
    """A point with that value of one variable; the others where the curvature expects them, or where they were."""
    centre = found.point + found.left
    with np.errstate(invalid="ignore", divide="ignore"):  # of a variable at a bound nothing is known
        slope = found.spread[:, index] / found.spread[index, index]
    still, moved = found.point.copy(), centre + (value - centre[index]) * np.where(np.isfinite(slope), slope, 0.0)
    still[index] = moved[index] = value
    return min((np.clip(point, *problem.bounds()) for point in (moved, still)), key=lambda point: cost_at(problem, point))


class _Held(SameVariables):
    """The problem with one variable held."""

    def __init__(self, problem: Problem, index: int, value: float, first: np.ndarray) -> None:
        super().__init__(problem)
        self.index, self.value, self.first = index, value, first

    def start(self) -> np.ndarray:
        return self.first

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        lower, upper = (bound.copy() for bound in self.problem.bounds())
        lower[self.index] = upper[self.index] = self.value
        return lower, upper

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.problem.residual_and_jacobian(scaled)
