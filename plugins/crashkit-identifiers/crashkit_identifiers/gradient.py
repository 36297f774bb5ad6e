"""The classical gradient method on growing slices of time."""

from functools import cache
from typing import ClassVar

import numpy as np
from attrs import evolve, field, frozen

from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit_identifiers.cost import cost_and_gradient, cost_at, is_least, stopped
from crashkit_identifiers.part import up_to
from crashkit_identifiers.recorded import with_recordings
from crashkit_identifiers.result import Path, conclude

FIRST_LENGTH = 0.01
"""Of the first step along the gradient: every parameter that is searched in its logarithm moves by 1 % at most."""
SHORTEST, LONGEST = 1e-10, 0.5


@frozen(eq=False)
class GradientState:
    """Where the search stands: `slice` is the number of the slice of time that it works on, `length` that of its last move."""

    point: np.ndarray
    cost: float
    status: Status
    slice: int = 1
    length: float = FIRST_LENGTH
    steps_in_slice: int = 0
    path: Path = field(default=())


@frozen
class Gradient(Identifier[GradientState]):
    """Steepest descent with a line search, on [0, T/n], [0, 2T/n], ... [0, T] (Mizzi & Jezequel 1992, eq 42-43).

    Each slice begins where the one before it ended. Slow, and seldom at the bottom of a narrow valley: a yardstick.

    Arguments:
        slices: n.
        steps_per_slice: at most.
        tolerance: relative drop in cost that ends a slice.
    """

    name: ClassVar[str] = "gradient"
    slices: int = 4
    steps_per_slice: int = 50
    tolerance: float = 1e-4

    def start(self, problem: Problem) -> GradientState:
        """The state at the problem's own start."""
        misfit = with_recordings(problem, self.name)
        point = np.clip(misfit.start(), *misfit.bounds())
        cost = cost_at(up_to(1.0 / self.slices, misfit), point)
        path = ((cost, misfit.parameters(point)),)
        return GradientState(point, cost, Status.RUNNING if np.isfinite(cost) else Status.FAILED, path=path)

    def step(self, problem: Problem, state: GradientState) -> GradientState:
        """One line search along the gradient; the next slice where there is nothing left to gain."""
        if state.status is not Status.RUNNING:
            return state
        part = up_to(state.slice / self.slices, with_recordings(problem, self.name))
        moved = _line_search(part, state)
        if moved is None:
            return self._next_slice(problem, state, _verdict(problem, state))
        moved = evolve(moved, path=(*state.path, (moved.cost, problem.parameters(moved.point))))
        if state.cost - moved.cost < self.tolerance * state.cost:
            return self._next_slice(problem, moved, _verdict(problem, moved))
        if moved.steps_in_slice >= self.steps_per_slice:
            return self._next_slice(problem, moved, Status.STEP_LIMIT)
        return moved

    def finish(self, problem: Problem, state: GradientState) -> Identification:
        """The parameters, with what the recordings themselves say of them."""
        return conclude(problem, state.point, state.status, state.path)

    def _next_slice(self, problem: Problem, state: GradientState, verdict: Status) -> GradientState:
        """The next slice at the same point, or the verdict on the last."""
        if state.slice == self.slices:
            return evolve(state, status=verdict)
        wider = up_to((state.slice + 1) / self.slices, with_recordings(problem, self.name))
        return evolve(state, slice=state.slice + 1, cost=cost_at(wider, state.point), steps_in_slice=0, length=FIRST_LENGTH)


def _verdict(problem: Problem, state: GradientState) -> Status:
    """A gradient search that stops gaining has seldom arrived."""
    return Status.CONVERGED if is_least(problem, state.point) else Status.STALLED


def _line_search(problem: Problem, state: GradientState) -> GradientState | None:
    """The least cost along the gradient: its length doubled or halved, then the vertex of a parabola; None: no step helps."""
    gradient = cost_and_gradient(problem, state.point)[1]
    downhill = np.where(stopped(problem, state.point, gradient), 0.0, -gradient)
    steepest = float(np.abs(downhill).max(initial=0.0))
    if steepest == 0.0:
        return None

    def at(length: float) -> np.ndarray:
        return np.clip(state.point + length / steepest * downhill, *problem.bounds())

    @cache
    def cost(length: float) -> float:
        return cost_at(problem, at(length)) if length else state.cost

    length = state.length
    while length > SHORTEST and cost(length) >= state.cost:
        length /= 2.0
    while 2.0 * length <= LONGEST and cost(2.0 * length) < cost(length):
        length *= 2.0
    best = min((length, _vertex(cost(0.0), cost(length), cost(2.0 * length)) * length), key=cost)
    if not cost(best) < state.cost:
        return None
    return evolve(state, point=at(best), cost=cost(best), length=best, steps_in_slice=state.steps_in_slice + 1)


def _vertex(start: float, middle: float, end: float) -> float:
    """Where the parabola through the costs at 0, 1 and 2 is least."""
    bend = start - 2.0 * middle + end
    return 1.0 + 0.5 * (start - end) / bend if np.isfinite(end) and bend > 0.0 else 1.0
