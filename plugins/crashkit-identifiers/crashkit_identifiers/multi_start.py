"""Several starts, each searched in growing slices of time at few instants; the best is then fitted to everything."""

import math
from typing import ClassVar

import numpy as np
from attrs import evolve, field, frozen

from crashkit.misfit import Misfit
from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit_identifiers.cost import cost_at, residual_at
from crashkit_identifiers.levenberg_marquardt import EXACT, BySearch, Limits, Search, advance, begin
from crashkit_identifiers.outliers import independent, judged, left_out, told
from crashkit_identifiers.part import Part, up_to
from crashkit_identifiers.prior import with_prior
from crashkit_identifiers.result import Path, conclude

WHOLE = (1.0,)
SLICES = (1 / 3, 2 / 3, 1.0)
"""Shares of the time recorded, one after the other: what an early threshold does is known before a late one is met."""
SHORT = Limits(tolerance=1e-2, least_drop=1.0, steps=25, reach=0.25)
"""Of the first start: short steps seldom jump over a threshold."""
LOOSE = Limits(tolerance=1e-2, least_drop=1.0, steps=8)
SCATTER = (0.4, 0.8, 1.2)
"""Relative scatter of further starts, by turns."""
DRAWS = 40
"""Of which the one with the least cost becomes a start: a cost without derivatives is cheap."""
JOLT = 2.0
"""Relative scatter of what the readings do not feel where a search has ended: a threshold out of reach, for example."""
UNFELT = 1e-9
"""Curvature, as a share of the largest, of a parameter that is not felt."""
AGREEING = 6
"""Starts that end in one place, after which it counts as the best there is."""
SAME = 1e-2
"""Relative difference of costs that are one."""
ROUNDS = 6
"""Of leaving out outliers."""


@frozen(eq=False)
class Attempts(BySearch):
    """Where the search stands.

    Arguments:
        search: the one under way.
        number: of its start.
        stage: the number of the slice of time that it works on; None once the best is fitted to everything.
        kept: which residuals are no outliers; (): all are kept.
        rounds: of leaving them out.
        ended: cost and point where each start ended.
        past: the path of the searches before.
        status: of the whole.
    """

    kept: np.ndarray = field(factory=lambda: np.zeros(0, dtype=bool))
    number: int = 0
    stage: int | None = 0
    rounds: int = 0
    ended: tuple[tuple[float, np.ndarray], ...] = field(default=())
    past: Path = field(default=())
    status: Status = Status.RUNNING

    @property
    def path(self) -> Path:
        """Of all searches."""
        return (*self.past, *self.search.path)


@frozen
class MultiStart(Identifier[Attempts]):
    """Gauss-Newton steps in a trust region of the parameters' logarithms, from as many starts as it takes.

    The first search begins at the model's own values, in short steps, at few instants. Where it ends above the noise, others
    follow: in slices of time that grow, from there, from starts scattered about it, and from the best so far with what is not
    felt there moved. The first that leaves no more than noise is taken; else, the best once six of them agree and all
    parameters are felt there, or of them all. It is fitted to all readings, and again without outliers.

    Arguments:
        starts: at most.
        tolerance: relative drop in cost that a step still has to promise.
        least_drop: drop in cost that it still has to promise; a statistical fit needs no more than 1e-3.
        step_limit: steps of the last search.
        prior: standard deviation of every search variable about its start, if that is known beforehand.
    """

    name: ClassVar[str] = "multi_start"
    starts: int = 24
    tolerance: float = 1e-10
    least_drop: float = 0.0
    step_limit: int = 100
    prior: float = math.inf

    def start(self, problem: Problem) -> Attempts:
        """The state at the problem's own start."""
        return Attempts(begin(self._early(problem, 1.0)))

    def step(self, problem: Problem, state: Attempts) -> Attempts:
        """One accepted step of the search under way, or the next search."""
        if state.status is not Status.RUNNING:
            return state
        if state.stage is not None:
            return self._guess(problem, state, state.stage)
        search = advance(self._late(problem, state.kept), state.search, self._limits(state))
        return evolve(state, search=search) if search.status is Status.RUNNING else self._judge(problem, state, search)

    def finish(self, problem: Problem, state: Attempts) -> Identification:
        """The parameters, with what is known of them without the outliers."""
        kept = state.kept
        count = None if kept.all() else independent(problem, kept)
        found = conclude(problem, state.point, state.status, state.path, self._late(problem, kept), count)
        attributes = found.parameters.attrs
        attributes["remarks"] = " ".join(filter(None, [attributes["remarks"], *self._remarks(problem, state)]))
        if isinstance(problem, Misfit) and not kept.all():
            attributes |= _with_outliers(problem, state.point, kept)
        return found

    def _guess(self, problem: Problem, state: Attempts, stage: int) -> Attempts:
        """A step at few instants, or what follows the last one."""
        shares, limits = (SLICES, LOOSE) if state.number else (WHOLE, SHORT)
        search = advance(self._early(problem, shares[stage]), state.search, limits)
        state = evolve(state, search=search)
        if search.status is Status.RUNNING:
            return state
        if stage + 1 < len(shares):
            following = begin(self._early(problem, shares[stage + 1]), search.point)
            return evolve(state, search=following, stage=stage + 1, past=state.path)
        return self._next(problem, evolve(state, ended=(*state.ended, (search.cost, search.point))))

    def _early(self, problem: Problem, share: float) -> Problem:
        """A slice of time at few instants."""
        if not isinstance(problem, Misfit):
            return with_prior(problem, self.prior)
        # A problem may have narrower bounds than its misfit at few instants, so it is asked for them.
        return with_prior(up_to(share, problem, problem.coarse), self.prior)

    def _late(self, problem: Problem, kept: np.ndarray) -> Problem:
        """All that is kept."""
        return with_prior(problem if kept.all() else Part(problem, kept), self.prior)

    def _limits(self, state: Attempts) -> Limits:
        """Of the last search; the first cost of all tells what rounding leaves."""
        return Limits(self.tolerance, max(self.least_drop, EXACT * state.path[0][0]), self.step_limit)

    def _next(self, problem: Problem, state: Attempts) -> Attempts:
        """The next start, unless one has arrived or enough of them agree."""
        cost, point = min(state.ended, key=lambda end: end[0])
        agreeing = sum(other <= cost + SAME * abs(cost) for other, _ in state.ended)
        if len(state.ended) >= self.starts and not np.isfinite(cost):
            return evolve(state, status=Status.FAILED)
        if len(state.ended) >= self.starts or (state.ended[-1][0] == cost and self._has_arrived(problem, point)):
            return self._fit_all(problem, state, point)
        if agreeing >= AGREEING and np.isfinite(cost) and not self._unfelt(problem, point).any():
            return self._fit_all(problem, state, point)
        first = self._start(problem, len(state.ended), point if np.isfinite(cost) else None)
        search = begin(self._early(problem, SLICES[0]), first)
        return evolve(state, search=search, number=len(state.ended), stage=0, past=state.path)

    def _has_arrived(self, problem: Problem, point: np.ndarray) -> bool:
        few = problem.coarse if isinstance(problem, Misfit) else problem
        residual = residual_at(few, point)
        return bool(np.isfinite(residual).all()) and judged(few, residual).at_noise

    def _start(self, problem: Problem, number: int, best: np.ndarray | None) -> np.ndarray:
        """The problem's own start, then others scattered about it and about the best so far; the same each time."""
        first = problem.start()
        if number == 1:
            return first
        scatter = np.full(len(first), SCATTER[number // 2 % len(SCATTER)])
        centre = first
        if best is not None and number % 2 == 0:
            centre, scatter = best, np.where(self._unfelt(problem, best), JOLT, scatter)
        relative = np.abs(problem.parameters(centre)) / problem.scaling(centre)
        size = scatter * np.where(relative > 0.0, relative, 1.0)
        draws = centre + size * np.random.default_rng(number).uniform(-1.0, 1.0, (DRAWS, len(first)))
        whole = self._early(problem, 1.0)
        return min(np.clip(draws, *problem.bounds()), key=lambda draw: cost_at(whole, draw))

    def _unfelt(self, problem: Problem, point: np.ndarray) -> np.ndarray:
        """Which parameters the readings do not feel at a point."""
        felt = np.sum(self._early(problem, 1.0).residual_and_jacobian(point)[1] ** 2, axis=0)
        return np.asarray(felt <= UNFELT * felt.max(initial=0.0))

    def _fit_all(self, problem: Problem, state: Attempts, point: np.ndarray) -> Attempts:
        """The search that ends at all readings."""
        search = begin(self._late(problem, state.kept), point)
        return evolve(state, search=search, stage=None, past=state.path)

    def _judge(self, problem: Problem, state: Attempts, search: Search) -> Attempts:
        """The end, or another round without the outliers."""
        state, residual = evolve(state, search=search), residual_at(problem, search.point)
        if not np.isfinite(residual).all():
            return evolve(state, status=Status.FAILED)
        verdict = judged(problem, residual)
        is_same = np.array_equal(verdict.kept, state.kept) or (verdict.kept.all() and state.kept.all())
        if is_same or state.rounds == ROUNDS:
            return evolve(state, status=search.status)
        again = begin(self._late(problem, verdict.kept), search.point)
        return evolve(state, search=again, kept=verdict.kept, rounds=state.rounds + 1, past=state.path)

    def _remarks(self, problem: Problem, state: Attempts) -> list[str]:
        """How many starts agree, if more than one was needed, and what was left out."""
        remarks = [told(problem, state.kept)]
        costs = np.array([cost for cost, _ in state.ended])
        if len(costs) > 1 and state.stage is None:
            same = int(np.sum(costs <= (1.0 + SAME) * costs.min()))
            remarks.append(f"{len(costs)} starts were searched from; {same} of them ended here.")
        return remarks


def _with_outliers(problem: Misfit, point: np.ndarray, kept: np.ndarray) -> dict[str, object]:
    """What was left out of each channel, and what remains of all readings."""
    residual = problem.discrepancy(point)
    normalised = float(np.sqrt(residual @ residual / problem.independent_samples))
    return {"left_out": left_out(problem, kept), "normalised_residual_of_all": normalised}
