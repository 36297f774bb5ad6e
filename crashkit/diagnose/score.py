"""The score test: how far the misfit would drop if a piece of physics were let in, judged from sensitivities alone."""

import numpy as np
from attrs import frozen

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

LONGEST_STEP = 0.3
"""Steps of more than this relative size in the model's own parameters are not trusted to be linear."""


@frozen
class Score:
    """What one Gauss-Newton step from the null promises.

    Attributes:
        values: of the model's and the new parameters to start a fit from: from the null, a fit can only gain.
        drop: of the sum of squares below the reference, once the model's own parameters have adjusted.
        deviation: standard deviation with which the recordings tell the size of the physics from nothing, the model's own
            parameters adjusting; in the unit of its first parameter, infinite where nothing shows it.
    """

    values: dict[str, float]
    drop: float
    deviation: float


def score(proposal: Proposal, start: dict[str, float], misfit: Misfit, reference: float) -> Score | None:
    """The promise of a proposal from one of its starts.

    minimise |r + J Δu|² over the new parameters and the model's own, within the bounds, from the null of the physics as far as
    the start does not say otherwise.

    Arguments:
        start: values by path; what it does not name keeps the model's value.
        misfit: of the proposal's model.
        reference: sum of squared residuals without the physics; infinite: as the model stands without moving.
    """
    point = misfit.start_at({**proposal.null, **start})
    try:
        residual, jacobian = misfit.residual_and_jacobian(point)
    except SimulationError:
        return None
    with np.errstate(over="ignore"):
        is_sound = np.isfinite(np.sum(residual**2)) and np.isfinite(np.sum(jacobian**2))
    if not is_sound:
        return None
    new = np.array([name in proposal.parameters for name in misfit.names])
    size = np.abs(misfit.parameters(point)) / misfit.scaling(point)
    reach = np.where(new | (size == 0), np.inf, LONGEST_STEP * size)
    step = _bounded_step(residual, jacobian, point, *misfit.bounds(), reach)
    reference = min(reference, float(residual @ residual)) if np.isinf(reference) else reference
    drop = reference - float(np.sum((residual + jacobian @ step) ** 2))
    own = np.array([name not in proposal.parameters for name in misfit.names])
    deviation = _deviation(jacobian[:, misfit.names.index(proposal.parameters[0])], jacobian[:, own], reach[own])
    return Score(misfit.values(point), drop, deviation)


def _deviation(amplitude: np.ndarray, own: np.ndarray, reach: np.ndarray) -> float:
    """Of a parameter whose derivatives are `amplitude`, when others with derivatives `own` may move by about `reach`."""
    curvature = own.T @ own + np.diag(1.0 / reach**2)
    hidden = own.T @ amplitude
    seen = amplitude @ amplitude - hidden @ np.linalg.lstsq(curvature, hidden, rcond=1e-14)[0]
    return float(1.0 / np.sqrt(seen)) if seen > 1e-12 * (amplitude @ amplitude) else float("inf")


def _bounded_step(
    residual: np.ndarray, jacobian: np.ndarray, point: np.ndarray, lower: np.ndarray, upper: np.ndarray, reach: np.ndarray
) -> np.ndarray:
    """The Gauss-Newton step, damped to about `reach`; parameters that would leave their bounds stop there."""
    curvature = jacobian.T @ jacobian
    gradient = jacobian.T @ residual
    weak = 1e-12 * max(float(np.diag(curvature).max(initial=0.0)), 1e-300)
    curvature[np.diag_indices_from(curvature)] += weak + 1.0 / reach**2
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
