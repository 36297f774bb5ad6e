"""What a least-squares step needs to know of the misfit at a point."""

import numpy as np

from crashkit.errors import SimulationError
from crashkit.protocols import Problem
from crashkit_identifiers.cost import unwarned


def normal_equations(problem: Problem, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """The residual r, and with its derivatives J the gradient J'r and the curvature J'J of r'r / 2.

    None where the model cannot be simulated, or blows up: a trial far from the data may, which is no reason to warn.

    Arguments:
        point: in search variables.
    """
    try:
        with unwarned():
            residual, jacobian = problem.residual_and_jacobian(point)
            gradient, curvature = jacobian.T @ residual, jacobian.T @ jacobian
            is_sound = np.isfinite(residual @ residual) and np.isfinite(curvature).all()
    except SimulationError:
        return None
    return (residual, gradient, curvature) if is_sound else None
