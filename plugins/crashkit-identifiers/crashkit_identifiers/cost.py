"""The cost of a point and its gradient, for methods that need no more."""

import numpy as np

from crashkit.errors import SimulationError
from crashkit.protocols import Problem

NOTHING = 0.01
"""Half a χ² that counts as nothing left to gain: a tenth of a standard deviation."""


def unwarned() -> np.errstate:
    """A trial far from the data may overflow, one at a bound divide by 0: its cost refuses it, which is no reason to warn."""
    return np.errstate(over="ignore", divide="ignore", invalid="ignore")


def cost_at(problem: Problem, point: np.ndarray) -> float:
    """Half the sum of squared residuals; infinite where the model cannot be simulated, or blows up."""
    return half_square(residual_at(problem, point))


def residual_at(problem: Problem, point: np.ndarray) -> np.ndarray:
    """The residuals; infinite where the model cannot be simulated."""
    try:
        with unwarned():
            return problem.residual(point)
    except SimulationError:
        return np.array([np.inf])


def half_square(residual: np.ndarray) -> float:
    """The cost of residuals; infinite where one of them is not finite."""
    with unwarned():
        cost = 0.5 * float(residual @ residual)
    return cost if np.isfinite(cost) else np.inf


def cost_and_gradient(problem: Problem, point: np.ndarray) -> tuple[float, np.ndarray]:
    """The cost and its derivatives to the search variables: dJ/du = Jᵀr, from forward sensitivities."""
    try:
        with unwarned():
            residual, jacobian = problem.residual_and_jacobian(point)
            cost, gradient = 0.5 * float(residual @ residual), jacobian.T @ residual
    except SimulationError:
        return np.inf, np.zeros(len(point))
    return (cost, gradient) if np.isfinite(cost) and np.isfinite(gradient).all() else (np.inf, np.zeros(len(point)))


def is_least(problem: Problem, point: np.ndarray) -> bool:
    """Whether a Gauss-Newton step within the bounds promises nothing that matters."""
    residual, jacobian = problem.residual_and_jacobian(point)
    gradient = jacobian.T @ residual
    free = ~stopped(problem, point, gradient)
    step = np.linalg.lstsq(jacobian[:, free], -residual, rcond=1e-8)[0]
    return bool(-0.5 * gradient[free] @ step <= NOTHING)


def stopped(problem: Problem, point: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    """Which variables a bound keeps from going downhill."""
    lower, upper = problem.bounds()
    return ((point <= lower) & (gradient > 0.0)) | ((point >= upper) & (gradient < 0.0))
