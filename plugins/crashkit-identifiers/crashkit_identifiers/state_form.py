"""The state form: a regression of measured accelerations, which needs no simulation and hardly a start."""

from collections.abc import Mapping
from functools import lru_cache
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.misfit import Misfit, SameVariables
from crashkit.protocols import Identification, Problem, Regression
from crashkit_identifiers.equation_error import EquationError
from crashkit_identifiers.levenberg_marquardt import BySearch, Limits, advance, begin
from crashkit_identifiers.measured import measured_motions, thinned
from crashkit_identifiers.recorded import with_recordings
from crashkit_identifiers.result import conclude

FACTORS = (1.0, 0.5, 0.25, 0.125, 2.0)
FEW = 80
"""Instants that make a start."""
SHARE, LONGER = 0.5, 4.0
"""Of the time between two of them, and times the step of the misfit: how long a step of the simulation may be there."""


@frozen(eq=False)
class Motions:
    """The measured motion of each run, and the longest step, s, in which a body that nobody saw is simulated beside it."""

    by_run: Mapping[str, xr.Dataset]
    step: float


@frozen(eq=False)
class RegressionState(BySearch):
    """Where the regression on the equations of motion, not on the recordings, stands, and what was measured."""

    measured: Motions


@frozen
class StateFormRegression(Regression[RegressionState]):
    """Least squares of x'' = f(X) U + g(X) on the measured state X (Mizzi & Jezequel 1992, eq 33).

    Linear while no threshold is crossed at another instant than before, so it is solved again as the intervals move. A
    threshold beyond all that was measured is felt by nothing, so it begins at the best of several multiples of the start. It
    starts other methods well. What a law remembers is integrated along the measured motion, and in one axis a body that no
    instrument sees is simulated beside it; in several every body that a joint holds must be seen.

    Arguments:
        step_limit: steps after which the search ends unconverged.
        instants: of each run, about so many; 0: all.
        factors: of the start, in the values of parameters that are searched in their logarithm.
    """

    name: ClassVar[str] = "state_form"
    step_limit: int = 60
    instants: int = 0
    factors: tuple[float, ...] = FACTORS

    def start(self, problem: Problem) -> RegressionState:
        """The state at the best of some multiples of the problem's own start."""
        misfit = with_recordings(problem, self.name)
        measured, step = measured_motions(misfit), misfit.step
        if self.instants:
            measured = {run: thinned(motion, self.instants) for run, motion in measured.items()}
            step = _longer_step(step, measured)
        motions = Motions(measured, step)
        searches = [begin(_From(_equations(misfit, motions), factor)) for factor in self.factors]
        return RegressionState(min(searches, key=lambda search: search.cost), motions)

    def step(self, problem: Problem, state: RegressionState) -> RegressionState:
        """One solution on the intervals that hold now."""
        return evolve(
            state, search=advance(self.equations(problem, state), state.search, Limits(tolerance=1e-8, steps=self.step_limit))
        )

    def moved(self, problem: Problem, state: RegressionState, point: np.ndarray) -> RegressionState:
        """The state at another point, along the same motion."""
        return evolve(state, search=begin(self.equations(problem, state), point))

    def equations(self, problem: Problem, state: RegressionState) -> Problem:
        """The equations of motion along the measured motion, over its noise."""
        return _equations(with_recordings(problem, self.name), state.measured)

    def finish(self, problem: Problem, state: RegressionState) -> Identification:
        """The parameters, with what the recordings themselves say of them."""
        return conclude(problem, state.point, state.status, state.path)


@frozen
class QuickRegression(StateFormRegression):
    """The state form from the start alone and at few instants: where to begin a search that simulates."""

    name: ClassVar[str] = "quick_state_form"
    instants: int = FEW
    factors: tuple[float, ...] = (1.0,)


@lru_cache(maxsize=16)
def _equations(misfit: Misfit, measured: Motions) -> EquationError:
    """Remembered: to set them up takes longer than a step."""
    return EquationError(misfit, measured.by_run, measured.step)


def _longer_step(step: float, measured: Mapping[str, xr.Dataset]) -> float:
    """In shorter ones no more is seen of what moves between the few instants that are looked at."""
    between = min(float(np.median(np.diff(motion["time"].values))) for motion in measured.values())
    return max(step, min(LONGER * step, SHARE * between))


class _From(SameVariables):
    """The problem from a multiple of its start."""

    def __init__(self, problem: Problem, factor: float) -> None:
        super().__init__(problem)
        self.factor = factor

    def start(self) -> np.ndarray:
        first = self.problem.start()
        return first + np.log(self.factor) * (self.problem.scaling(first) != 1.0)

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return self.problem.residual_and_jacobian(scaled)
