"""The sensitivity method: Newton-type steps from the derivatives of the simulated motion."""

import math
from typing import ClassVar

from attrs import frozen

from crashkit.protocols import Identification, Identifier, Problem
from crashkit_identifiers.levenberg_marquardt import Limits, Search, advance, begin
from crashkit_identifiers.prior import with_prior
from crashkit_identifiers.result import conclude


@frozen
class Sensitivity(Identifier[Search]):
    """Levenberg-Marquardt steps within bounds, from forward sensitivities (Mizzi & Jezequel 1992, eq 47-55).

    Arguments:
        tolerance: relative drop in cost that a full step still has to promise.
        least_drop: drop in cost that it still has to promise; a statistical fit needs no more than 1e-3.
        step_limit: steps after which the search ends unconverged.
        prior: standard deviation of every search variable about its start, if that is known beforehand.
    """

    name: ClassVar[str] = "sensitivity"
    tolerance: float = 1e-10
    least_drop: float = 0.0
    step_limit: int = 100
    prior: float = math.inf

    def start(self, problem: Problem) -> Search:
        """The state at the problem's own start."""
        return begin(with_prior(problem, self.prior))

    def step(self, problem: Problem, state: Search) -> Search:
        """One accepted step, or a verdict that there is none."""
        return advance(with_prior(problem, self.prior), state, Limits(self.tolerance, self.least_drop, self.step_limit))

    def finish(self, problem: Problem, state: Search) -> Identification:
        """Parameters with covariance, what the data do not see, and the path."""
        return conclude(problem, state.point, state.status, state.path, with_prior(problem, self.prior))
