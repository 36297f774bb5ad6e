"""Optimal control: steps that need the gradient alone, which an adjoint gives at one price for any number of parameters."""

import math
from typing import ClassVar

import numpy as np
from attrs import evolve, field, frozen

from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit_identifiers.adjoint import cost_and_cheapest_gradient
from crashkit_identifiers.cost import is_least, stopped
from crashkit_identifiers.prior import with_prior
from crashkit_identifiers.result import Path, conclude

FIRST_LENGTH = 0.05
"""Of the first step: a parameter that is searched in its logarithm moves by 5 % at most."""
LONGEST = 1.0
"""No step changes such a parameter by more than a factor e."""
SUFFICIENT, CURVED = 1e-4, 0.9
"""Wolfe's conditions: share of the promised drop, and of the slope, that a step must keep or lose."""
TRIALS = 20


@frozen(eq=False)
class ControlState:
    """Where the search stands: the point, its cost and gradient, and the inverse curvature learnt on the way."""

    point: np.ndarray
    cost: float
    gradient: np.ndarray
    inverse: np.ndarray
    status: Status
    path: Path = field(default=())


@frozen
class OptimalControl(Identifier[ControlState]):
    """Quasi-Newton steps (BFGS) within bounds, from the gradient alone (Mizzi & Jezequel 1992, eq 56-64).

    minimise J(U) subject to X' = f(X) U + g(X). The adjoint's gradient costs the same however many parameters there are, so it
    is taken where they are many; of few, forward sensitivities give the same gradient for less.

    Arguments:
        tolerance: relative drop in cost below which a step counts as none.
        step_limit: steps after which the search ends unconverged.
        prior: standard deviation of every search variable about its start, if that is known beforehand.
    """

    name: ClassVar[str] = "optimal_control"
    tolerance: float = 1e-10
    step_limit: int = 300
    prior: float = math.inf

    def start(self, problem: Problem) -> ControlState:
        """The state at the problem's own start."""
        problem = with_prior(problem, self.prior)
        point = np.clip(problem.start(), *problem.bounds())
        cost, gradient = cost_and_cheapest_gradient(problem, point)
        status = Status.RUNNING if np.isfinite(cost) else Status.FAILED
        return ControlState(point, cost, gradient, _unlearnt(gradient), status, ((cost, problem.parameters(point)),))

    def step(self, problem: Problem, state: ControlState) -> ControlState:
        """One line search along the quasi-Newton direction; a fresh start along the gradient where that leads nowhere."""
        if state.status is not Status.RUNNING:
            return state
        if len(state.path) > self.step_limit:
            return evolve(state, status=Status.STEP_LIMIT)
        problem = with_prior(problem, self.prior)
        for inverse in (state.inverse, _unlearnt(state.gradient)):
            found = _line_search(problem, evolve(state, inverse=inverse))
            if found is not None and state.cost - found.cost > self.tolerance * state.cost:
                return evolve(found, path=(*state.path, (found.cost, problem.parameters(found.point))))
        return evolve(state, status=Status.CONVERGED if is_least(problem, state.point) else Status.STALLED)

    def finish(self, problem: Problem, state: ControlState) -> Identification:
        """Parameters with covariance, what the data do not see, and the path."""
        return conclude(problem, state.point, state.status, state.path, with_prior(problem, self.prior))


def _unlearnt(gradient: np.ndarray) -> np.ndarray:
    """An inverse curvature whose step is as long as `FIRST_LENGTH`."""
    return np.eye(len(gradient)) * FIRST_LENGTH / max(float(np.abs(gradient).max(initial=0.0)), 1e-300)


def _line_search(problem: Problem, state: ControlState) -> ControlState | None:
    """A point that fulfils Wolfe's conditions, by doubling and bisection; with the curvature that it teaches."""
    free = ~stopped(problem, state.point, state.gradient)
    direction = np.zeros(len(state.point))
    direction[free] = -state.inverse[np.ix_(free, free)] @ state.gradient[free]
    slope = float(state.gradient @ direction)
    if not slope < 0.0:
        return None
    length, least, most = min(1.0, LONGEST / float(np.abs(direction).max())), 0.0, np.inf
    best: ControlState | None = None
    for _ in range(TRIALS):
        point = np.clip(state.point + length * direction, *problem.bounds())
        cost, gradient = cost_and_cheapest_gradient(problem, point)
        if cost > state.cost + SUFFICIENT * length * slope:
            most = length
        else:
            best = evolve(state, point=point, cost=cost, gradient=gradient, inverse=_learnt(state, point, gradient))
            if gradient @ direction >= CURVED * slope or length * np.abs(direction).max() >= LONGEST:
                return best
            least = length
        length = 0.5 * (least + most) if np.isfinite(most) else min(2.0 * length, LONGEST / float(np.abs(direction).max()))
    return best


def _learnt(state: ControlState, point: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """The inverse curvature after a step s that changed the gradient by y (Broyden, Fletcher, Goldfarb, Shanno 1970)."""
    s, y = point - state.point, gradient - state.gradient
    if not s @ y > 1e-12 * np.linalg.norm(s) * np.linalg.norm(y):
        return state.inverse
    first = len(state.path) == 1
    inverse = np.eye(len(s)) * (s @ y) / (y @ y) if first else state.inverse
    turn = np.eye(len(s)) - np.outer(s, y) / (s @ y)
    return turn @ inverse @ turn.T + np.outer(s, s) / (s @ y)
