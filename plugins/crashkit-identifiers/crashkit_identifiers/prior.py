"""What is known of the parameters beforehand, as one more residual for each of them."""

import math

import numpy as np

from crashkit.errors import CrashkitError
from crashkit.misfit import SameVariables
from crashkit.protocols import Problem


class WithPrior(SameVariables):
    """The residuals and (u - u_0) / s, with u_0 the problem's start: the term in R of Mizzi & Jezequel 1992, eq 52.

    Arguments:
        problem: whose residuals are kept.
        std: s, of every search variable; 0.2 is 20 % of a parameter that is searched in its logarithm.
    """

    def __init__(self, problem: Problem, std: float) -> None:
        super().__init__(problem)
        if not std > 0.0:
            raise CrashkitError(f"prior: expected a standard deviation above 0, found {std:g}")
        self.std, self.first = std, problem.start()

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """The residuals, and then one for each parameter."""
        return np.concatenate([self.problem.residual(scaled), (scaled - self.first) / self.std])

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The residuals and their derivatives."""
        residual, jacobian = self.problem.residual_and_jacobian(scaled)
        own = np.eye(len(scaled)) / self.std
        return np.concatenate([residual, (scaled - self.first) / self.std]), np.concatenate([jacobian, own])


def with_prior(problem: Problem, std: float) -> Problem:
    """The problem with a prior; the problem itself where `std` is infinite."""
    return problem if math.isinf(std) else WithPrior(problem, std)
