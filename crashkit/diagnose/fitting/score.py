"""The score test: how far the misfit would drop if a piece of physics were let in, judged from sensitivities alone."""

from collections.abc import Mapping

import numpy as np
from attrs import frozen

from crashkit.diagnose.fitting.quadratic import Extended, Quadratic
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


def score(proposal: Proposal, start: Mapping[str, float], extended: Extended, reference: float) -> Score | None:
    """The promise of a proposal from one of its starts; None where it cannot be simulated there.

    minimise |r + J Δu|² over the new parameters and the model's own, within the bounds, from the null of the physics as far as
    the start does not say otherwise.

    Arguments:
        start: values by path; what it does not name keeps the model's value.
        extended: the proposal's model.
        reference: sum of squared residuals without the physics; infinite: as the model stands without moving.
    """
    misfit = extended.misfit
    point = misfit.start_at({**proposal.null, **start})
    is_absent = bool(proposal.null) and all(start.get(path, value) == value for path, value in proposal.null.items())
    square = extended.at(point, is_absent)
    if square is None:
        return None
    new = np.array([name in proposal.parameters for name in misfit.names])
    size = np.abs(misfit.parameters(point)) / misfit.scaling(point)
    reach = np.where(new | (size == 0), np.inf, LONGEST_STEP * size)
    step = _bounded_step(square, point, *misfit.bounds(), reach)
    reference = min(reference, square.value) if np.isinf(reference) else reference
    amplitude = misfit.names.index(proposal.parameters[0])
    deviation = _deviation(square.curvature, amplitude, np.flatnonzero(~new), reach) * misfit.scaling(point)[amplitude]
    return Score(misfit.values(point), reference - square.after(step), float(deviation))


def _deviation(curvature: np.ndarray, amplitude: int, own: np.ndarray, reach: np.ndarray) -> float:
    """Of one parameter, when the model's own may move by about `reach`."""
    adjusting = curvature[np.ix_(own, own)] + np.diag(1.0 / reach[own] ** 2)
    whole, hidden = curvature[amplitude, amplitude], curvature[own, amplitude]
    seen = whole - hidden @ np.linalg.lstsq(adjusting, hidden, rcond=1e-14)[0]
    return float(1.0 / np.sqrt(seen)) if seen > 1e-12 * whole else float("inf")


def _bounded_step(square: Quadratic, point: np.ndarray, lower: np.ndarray, upper: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """The Gauss-Newton step, damped to about `reach`; parameters that would leave their bounds stop there."""
    curvature = square.curvature.copy()
    weak = 1e-12 * max(float(np.diag(curvature).max(initial=0.0)), 1e-300)
    curvature[np.diag_indices_from(curvature)] += weak + 1.0 / reach**2
    free, step = np.ones(len(point), dtype=bool), np.zeros(len(point))
    for _ in range(len(point)):
        held = curvature[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.lstsq(curvature[np.ix_(free, free)], -(square.gradient[free] + held), rcond=1e-14)[0]
        outside = free & ((point + step < lower) | (point + step > upper))
        if not outside.any():
            break
        step[outside] = np.clip(point + step, lower, upper)[outside] - point[outside]
        free &= ~outside
    return step
