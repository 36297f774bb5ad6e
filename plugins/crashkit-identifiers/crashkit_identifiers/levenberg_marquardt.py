"""Levenberg-Marquardt steps within bounds: the search that several methods share, each on a problem of its own."""

import numpy as np
from attrs import evolve, field, frozen

from crashkit.protocols import Problem, Status
from crashkit_identifiers.cost import cost_at
from crashkit_identifiers.normal_equations import normal_equations

FIRST_DAMPING = 1e-3
LARGEST_DAMPING = 1e12
SHORT_STEPS = 1e4
"""Damping from which a step is too short to tell."""
ATTEMPTS = 12
CHANCE = 1.0
"""Half a χ² that chance alone makes."""
EXACT = 1e-22
"""Share of the first cost that rounding leaves where a model fits exactly."""


@frozen
class Search:
    """Where a search stands: the point, its cost, gradient and Gauss-Newton curvature, and the path so far."""

    point: np.ndarray
    cost: float
    gradient: np.ndarray
    curvature: np.ndarray
    damping: float
    status: Status = Status.RUNNING
    path: tuple[tuple[float, np.ndarray], ...] = field(default=())


@frozen(eq=False)
class BySearch:
    """What stands where its search does."""

    search: Search

    @property
    def point(self) -> np.ndarray:
        """In search variables."""
        return self.search.point

    @property
    def cost(self) -> float:
        """Of what is searched."""
        return self.search.cost

    @property
    def status(self) -> Status:
        """Of the search."""
        return self.search.status

    @property
    def path(self) -> tuple[tuple[float, np.ndarray], ...]:
        """Of the search."""
        return self.search.path


@frozen
class Limits:
    """When a search ends.

    Arguments:
        tolerance: relative drop in cost that a full step still has to promise.
        least_drop: drop in cost that it still has to promise.
        steps: after which the search ends unconverged.
        reach: of one step in a parameter that is searched in its logarithm: 1 is a factor e.
    """

    tolerance: float = 1e-10
    least_drop: float = 0.0
    steps: int = 100
    reach: float = 1.0


def begin(problem: Problem, point: np.ndarray | None = None) -> Search:
    """The search at a point, else at the problem's own start, brought within the bounds."""
    first = problem.start() if point is None else point
    return _search_at(problem, np.clip(first, *problem.bounds()), FIRST_DAMPING, ())


def advance(problem: Problem, search: Search, limits: Limits) -> Search:
    """One accepted step, or a verdict that there is none.

    minimise ½ |r(u)|²:  (JᵀJ + λ diag JᵀJ) Δu = -Jᵀr over the parameters that no bound holds.
    """
    if search.status is not Status.RUNNING:
        return search
    if len(search.path) > limits.steps:
        return evolve(search, status=Status.STEP_LIMIT)
    for attempt in range(ATTEMPTS):
        move = damped_step(problem, search, limits.reach)
        promised = promise(search, move)
        if promised <= max(limits.tolerance * search.cost, limits.least_drop, EXACT * search.path[0][0]):
            return evolve(search, status=_verdict(problem, search, limits.reach))
        # After a refusal another is likely, and the cost alone is known in a fraction of the time of its derivatives.
        if attempt == 0 or _is_kept(search, cost_at(problem, search.point + move), promised):
            accepted = _attempt(problem, search, search.point + move, promised)
            if accepted is not None:
                return accepted
        search = evolve(search, damping=min(search.damping * 8.0, LARGEST_DAMPING))
    return evolve(search, status=_verdict(problem, search, limits.reach))


def promise(search: Search, move: np.ndarray) -> float:
    """The drop in cost that the derivatives promise of a step."""
    return -float(search.gradient @ move + 0.5 * move @ search.curvature @ move)


def _search_at(problem: Problem, point: np.ndarray, damping: float, path: tuple[tuple[float, np.ndarray], ...]) -> Search:
    """The cost and its derivatives at a point; where the model cannot be simulated, or blows up, the cost is infinite."""
    there = normal_equations(problem, point)
    if there is None:
        return Search(point, np.inf, np.zeros(len(point)), np.eye(len(point)), damping, Status.FAILED, path)
    residual, gradient, curvature = there
    cost = 0.5 * float(residual @ residual)
    path = (*path, (cost, problem.parameters(point)))
    return Search(point, cost, gradient, curvature, damping, Status.RUNNING, path)


def damped_step(problem: Problem, search: Search, reach: float) -> np.ndarray:
    """The damped Gauss-Newton step within the bounds: what they stop is held there, until the others' moves draw it back."""
    lower, upper = _within(problem, search, reach)
    scale = np.diag(search.curvature).copy()
    scale[scale <= 0] = max(float(scale.max(initial=0.0)), 1.0) * 1e-12
    root = np.sqrt(scale)
    damped = search.curvature / np.outer(root, root)
    damped.flat[:: len(root) + 1] += search.damping
    move = -np.linalg.solve(damped, search.gradient / root) / root
    target = search.point + move
    if ((target >= lower) & (target <= upper)).all():
        return move
    return _stopped_step(search, damped * np.outer(root, root), lower, upper)


def _stopped_step(search: Search, damped: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """The least of the damped parabola within bounds, by taking variables to their bounds and back."""
    move, free = np.zeros(len(search.point)), np.ones(len(search.point), dtype=bool)
    for _ in range(3 * len(move) + 1):
        move[free] = _solved(damped[free][:, free], search.gradient[free] + damped[free][:, ~free] @ move[~free])
        target = search.point + move
        outside = free & ((target < lower) | (target > upper))
        move[outside] = np.clip(target, lower, upper)[outside] - search.point[outside]
        slope = search.gradient + damped @ move
        inward = ~free & (lower < upper) & np.where(target <= lower, slope < 0.0, slope > 0.0)
        if not outside.any() and not inward.any():
            break
        free = free & ~outside if outside.any() else free | inward
    return move


def _solved(matrix: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """The step to the least of a parabola, solved with its diagonal scaled to 1."""
    root = np.sqrt(np.diag(matrix))
    return -np.linalg.solve(matrix / np.outer(root, root), gradient / root) / root


def _within(problem: Problem, search: Search, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """The bounds of one step: those of the problem, and not too far in a logarithm."""
    lower, upper = problem.bounds()
    logarithmic = problem.scaling(search.point) != 1.0
    lower = np.where(logarithmic, np.maximum(lower, search.point - reach), lower)
    return lower, np.where(logarithmic, np.minimum(upper, search.point + reach), upper)


def _attempt(problem: Problem, search: Search, point: np.ndarray, promised: float) -> Search | None:
    """The search at `point`, if it keeps enough of the promise."""
    there = _search_at(problem, point, search.damping, search.path)
    if not _is_kept(search, there.cost, promised):
        return None
    damping = search.damping / 5.0 if search.cost - there.cost > 0.5 * promised else search.damping * 1.5
    return evolve(there, damping=max(damping, 1e-15))


def _is_kept(search: Search, cost: float, promised: float) -> bool:
    """Whether a step to this cost keeps enough of what it promised."""
    return search.cost - cost > 1e-4 * promised


def _verdict(problem: Problem, search: Search, reach: float) -> Status:
    """A promise of nothing under heavy damping only says that the steps have become short.

    It has converged all the same where an undamped step promises, and does not keep, what chance alone makes of a misfit: the
    least misfit is at a kink, where a threshold was reached.
    """
    if search.damping < SHORT_STEPS:
        return Status.CONVERGED
    undamped = evolve(search, damping=FIRST_DAMPING)
    is_chance = promise(undamped, damped_step(problem, undamped, reach)) < CHANCE
    return Status.CONVERGED if is_chance else Status.STALLED
