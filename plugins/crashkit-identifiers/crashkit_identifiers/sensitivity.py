"""The sensitivity method: Newton-type steps from the derivatives of the simulated motion."""

from typing import ClassVar

import numpy as np
from attrs import evolve, field, frozen

from crashkit.errors import SimulationError
from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit_identifiers.result import summarise

FIRST_DAMPING = 1e-3
LARGEST_DAMPING = 1e12
ATTEMPTS = 12
LONGEST_STEP = 1.0
"""Of a parameter that is searched in its logarithm: no step changes it by more than a factor e."""
EXACT = 1e-22
"""Share of the first cost that rounding leaves where a model fits exactly."""


@frozen
class SensitivityState:
    """Where a search stands: the point, its cost, gradient and Gauss-Newton curvature, and the path so far."""

    point: np.ndarray
    cost: float
    gradient: np.ndarray
    curvature: np.ndarray
    damping: float
    status: Status
    path: tuple[tuple[float, np.ndarray], ...] = field(default=())


@frozen
class Sensitivity(Identifier[SensitivityState]):
    """Levenberg-Marquardt steps within bounds, from forward sensitivities (Mizzi & Jezequel 1992, eq 47-55).

    minimise ½ |r(u)|²:  (JᵀJ + λ diag JᵀJ) Δu = -Jᵀr over the parameters that no bound holds.

    Arguments:
        tolerance: relative drop in cost that a full step still has to promise.
        least_drop: drop in cost that it still has to promise; a statistical fit needs no more than 1e-3.
        step_limit: steps after which the search ends unconverged.
    """

    name: ClassVar[str] = "sensitivity"
    tolerance: float = 1e-10
    least_drop: float = 0.0
    step_limit: int = 100

    def start(self, problem: Problem) -> SensitivityState:
        """The state at the problem's own start."""
        lower, upper = problem.bounds()
        return _state_at(problem, np.clip(problem.start(), lower, upper), FIRST_DAMPING, ())

    def step(self, problem: Problem, state: SensitivityState) -> SensitivityState:
        """One accepted step, or a verdict that there is none."""
        if state.status is not Status.RUNNING:
            return state
        if len(state.path) > self.step_limit:
            return evolve(state, status=Status.STEP_LIMIT)
        for _ in range(ATTEMPTS):
            move = _move(problem, state)
            promised = -(state.gradient @ move + 0.5 * move @ state.curvature @ move)
            if promised <= max(self.tolerance * state.cost, self.least_drop, EXACT * state.path[0][0]):
                return evolve(state, status=_verdict(state))
            accepted = _attempt(problem, state, state.point + move, promised)
            if accepted is not None:
                return accepted
            state = evolve(state, damping=min(state.damping * 8.0, LARGEST_DAMPING))
        return evolve(state, status=Status.STALLED)

    def finish(self, problem: Problem, state: SensitivityState) -> Identification:
        """Parameters with covariance, what the data do not see, and the path."""
        return summarise(problem, state.point, state.cost, state.curvature, state.status, state.path)

    def run(self, problem: Problem) -> Identification:
        """From start to finish."""
        state = self.start(problem)
        while state.status is Status.RUNNING:
            state = self.step(problem, state)
        return self.finish(problem, state)


def _state_at(
    problem: Problem, point: np.ndarray, damping: float, path: tuple[tuple[float, np.ndarray], ...]
) -> SensitivityState:
    """The cost and its derivatives at a point; where the model cannot be simulated, or blows up, the cost is infinite."""
    cost, gradient, curvature = np.inf, np.zeros(len(point)), np.eye(len(point))
    try:
        # A trial far from the data may overflow: it is refused by its cost, which is no reason to warn.
        with np.errstate(over="ignore", invalid="ignore"):
            residual, jacobian = problem.residual_and_jacobian(point)
            cost = 0.5 * float(residual @ residual)
            gradient, curvature = jacobian.T @ residual, jacobian.T @ jacobian
    except SimulationError:
        pass
    if not np.isfinite(cost) or not np.isfinite(curvature).all():
        blank = np.zeros(len(point)), np.eye(len(point))
        return SensitivityState(point, np.inf, *blank, damping, Status.FAILED, path)
    path = (*path, (cost, problem.parameters(point)))
    return SensitivityState(point, cost, gradient, curvature, damping, Status.RUNNING, path)


def _move(problem: Problem, state: SensitivityState) -> np.ndarray:
    """The damped Gauss-Newton step within the bounds: what they stop is held there, until the others' moves draw it back."""
    lower, upper = _reach(problem, state)
    scale = np.diag(state.curvature).copy()
    scale[scale <= 0] = max(float(scale.max(initial=0.0)), 1.0) * 1e-12
    damped = state.curvature + state.damping * np.diag(scale)
    move = np.zeros(len(state.point))
    free = np.ones(len(move), dtype=bool)
    for _ in range(3 * len(move) + 1):
        move[free] = _solve(state, scale, free, move)
        target = state.point + move
        outside = free & ((target < lower) | (target > upper))
        move[outside] = np.clip(target, lower, upper)[outside] - state.point[outside]
        slope = state.gradient + damped @ move
        inward = ~free & np.where(target <= lower, slope < 0.0, slope > 0.0)
        if not outside.any() and not inward.any():
            break
        free = free & ~outside if outside.any() else free | inward
    return move


def _reach(problem: Problem, state: SensitivityState) -> tuple[np.ndarray, np.ndarray]:
    """The bounds of one step: those of the problem, and not too far in a logarithm."""
    lower, upper = problem.bounds()
    logarithmic = problem.scaling(state.point) != 1.0
    lower = np.where(logarithmic, np.maximum(lower, state.point - LONGEST_STEP), lower)
    return lower, np.where(logarithmic, np.minimum(upper, state.point + LONGEST_STEP), upper)


def _solve(state: SensitivityState, scale: np.ndarray, free: np.ndarray, move: np.ndarray) -> np.ndarray:
    root = np.sqrt(scale[free])
    held = state.curvature[np.ix_(free, ~free)] @ move[~free]
    matrix = state.curvature[np.ix_(free, free)] / np.outer(root, root) + state.damping * np.eye(int(free.sum()))
    return -np.linalg.solve(matrix, (state.gradient[free] + held) / root) / root


def _attempt(problem: Problem, state: SensitivityState, point: np.ndarray, promised: float) -> SensitivityState | None:
    """The state at `point`, if it keeps enough of the promise."""
    there = _state_at(problem, point, state.damping, state.path)
    gained = state.cost - there.cost
    if not gained > 1e-4 * promised:
        return None
    damping = state.damping / 5.0 if gained > 0.5 * promised else state.damping * 1.5
    return evolve(there, damping=max(damping, 1e-15))


def _verdict(state: SensitivityState) -> Status:
    """A promise of nothing under heavy damping only says that the steps have become short."""
    return Status.CONVERGED if state.damping < 1e4 else Status.STALLED
