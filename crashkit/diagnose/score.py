"""The score test: how far the misfit would drop if a piece of physics were let in, judged from sensitivities alone."""

import numpy as np
from attrs import frozen

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

PRIOR_STD = 0.3
"""Steps of more than this relative size in the model's own parameters are not trusted to be linear."""


@frozen
class Score:
    """What one Gauss-Newton step from the null promises.

    Attributes:
        proposal: the physics.
        values: of the model's and the new parameters to start a fit from.
        drop: in the sum of squares, once the model's own parameters have adjusted.
    """

    proposal: Proposal
    values: dict[str, float]
    drop: float


def score(proposal: Proposal, start: dict[str, float], misfit: Misfit) -> Score | None:
    """The promise of a proposal from one of its starts.

    minimise |r + J Δu|² over the new parameters and the model's own, at the null of the physics, within the new
    parameters' bounds. A proposal without a null promises whatever its start already gains.

    Arguments:
        misfit: of the proposal's model.
    """
    point = misfit.scaled(np.array([{**start, **proposal.null}.get(n, p.value) for n, p in misfit.model.free_parameters().items()]))
    try:
        residual, jacobian = misfit.residual_and_jacobian(point)
    except SimulationError:
        return None
    new = np.array([name in proposal.parameters for name in misfit.names])
    step = _bounded_step(residual, jacobian, point, *misfit.bounds(), new)
    drop = float(residual @ residual - np.sum((residual + jacobian @ step) ** 2))
    moved = np.where(new, point + step, point)
    return Score(proposal, misfit.values(moved), drop)


def _bounded_step(
    residual: np.ndarray, jacobian: np.ndarray, point: np.ndarray, lower: np.ndarray, upper: np.ndarray, new: np.ndarray
) -> np.ndarray:
    """The Gauss-Newton step; new parameters that would leave their bounds stop there."""
    curvature = jacobian.T @ jacobian
    gradient = jacobian.T @ residual
    weak = 1e-12 * max(float(np.diag(curvature).max(initial=0.0)), 1e-300)
    curvature[np.diag_indices_from(curvature)] += np.where(new, weak, 1.0 / PRIOR_STD**2)
    free, step = np.ones(len(point), dtype=bool), np.zeros(len(point))
    for _ in range(len(point)):
        held = curvature[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.lstsq(curvature[np.ix_(free, free)], -(gradient[free] + held), rcond=1e-14)[0]
        outside = free & ((point + step < lower) | (point + step > upper))
        if not outside.any():
            break
        step[outside] = np.clip(point + step, lower, upper)[outside] - point[outside]
        free &= ~outside
    return step
