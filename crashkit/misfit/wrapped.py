"""Another misfit over the same search variables: what several methods minimise instead of the misfit itself."""

from abc import ABC, abstractmethod

import numpy as np

from crashkit.protocols import Problem


class SameVariables(ABC):
    """A problem with the search variables of another and residuals of its own.

    Arguments:
        problem: whose parameters are searched.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.names = problem.names

    @abstractmethod
    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals and their derivatives to the search variables."""

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """The residuals alone."""
        return self.residual_and_jacobian(scaled)[0]

    def start(self) -> np.ndarray:
        """The other problem's start."""
        return self.problem.start()

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """The other problem's bounds."""
        return self.problem.bounds()

    def parameters(self, scaled: np.ndarray) -> np.ndarray:
        """The parameters in their own units."""
        return self.problem.parameters(scaled)

    def scaling(self, scaled: np.ndarray) -> np.ndarray:
        """d parameter / d search variable."""
        return self.problem.scaling(scaled)
