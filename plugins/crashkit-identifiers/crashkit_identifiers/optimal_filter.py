"""The optimal least-squares filter: the parameters join the state, and every measured instant corrects both."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve, field, frozen

from crashkit.misfit import Misfit
from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit_identifiers.cost import cost_at, is_least
from crashkit_identifiers.line_dynamics import LineDynamics
from crashkit_identifiers.measured import measured_motions, require_seen, thinned
from crashkit_identifiers.recorded import require_plain_line, with_recordings
from crashkit_identifiers.result import Path, conclude

INSTANTS = 450
"""Of a run, about, at which the filter corrects: a smoothed motion tells no more at others."""
SETTLED = 1e-6
"""A pass that changes no search variable by more has nothing left to correct."""


@frozen(eq=False)
class PassState:
    """Where the passes stand: the parameters after the last, and the measured motion of each run."""

    point: np.ndarray
    cost: float
    status: Status
    measured: Mapping[str, xr.Dataset]
    path: Path = field(default=())


@frozen
class OptimalFilter(Identifier[PassState]):
    """Sequential estimation of state and parameters, in several passes (Mizzi & Jezequel 1992, eq 44-45).

    After Distefano & Rath 1975, Computer Methods in Applied Mechanics and Engineering 5, 353.

    With A = (X, U), A' = G(A) = (F(X, U), 0), the estimate that minimises ∫ |W - N A|² dt + |A(0) - A_0|²_P follows

    A' = G(A) + Q Nᵀ R⁻¹ (W - N A),   Q' = G_A Q + Q G_Aᵀ - Q Nᵀ R⁻¹ N Q,   Q(0) = P⁻¹,

    here from one measured instant to the next, with W the measured positions and velocities. One axis; every body that a joint
    holds must be seen by an instrument. What a short impact shows of a parameter is gone before the filter has learnt the
    others, so it needs several passes, and may not arrive.

    Arguments:
        prior: standard deviation of the search variables about their values at the start of each pass.
        distrust: what is added, in the first pass, to the noise of each measured state, as a share of its range: a filter that
            believes exact measurements from wrong parameters overshoots. It is halved with every pass.
        passes: at most.
    """

    name: ClassVar[str] = "optimal_filter"
    prior: float = 0.1
    distrust: float = 0.03
    passes: int = 30

    def start(self, problem: Problem) -> PassState:
        """The state at the problem's own start."""
        misfit = with_recordings(problem, self.name)
        require_plain_line(misfit, self.name)
        measured = {run: thinned(motion, INSTANTS) for run, motion in measured_motions(misfit).items()}
        require_seen(misfit, measured, self.name)
        point = np.clip(misfit.start(), *misfit.bounds())
        cost = cost_at(misfit, point)
        status = Status.RUNNING if np.isfinite(cost) else Status.FAILED
        return PassState(point, cost, status, measured, ((cost, misfit.parameters(point)),))

    def step(self, problem: Problem, state: PassState) -> PassState:
        """One pass over all runs."""
        if state.status is not Status.RUNNING:
            return state
        misfit = with_recordings(problem, self.name)
        if len(state.path) > self.passes:
            return evolve(state, status=Status.STEP_LIMIT)
        point, covariance = state.point, np.eye(len(state.point)) * self.prior**2
        distrust = self.distrust * 0.5 ** (len(state.path) - 1)
        for motion in state.measured.values():
            point, covariance = _filtered(misfit, motion, point, covariance, distrust)
        if not np.isfinite(point).all():
            return evolve(state, status=Status.STALLED)
        cost = cost_at(misfit, point)
        moved = evolve(state, point=point, cost=cost, path=(*state.path, (cost, misfit.parameters(point))))
        if np.abs(point - state.point).max(initial=0.0) > SETTLED:
            return moved
        return evolve(moved, status=Status.CONVERGED if is_least(misfit, point) else Status.STALLED)

    def finish(self, problem: Problem, state: PassState) -> Identification:
        """The parameters, with what the recordings themselves say of them."""
        return conclude(problem, state.point, state.status, state.path)


def _filtered(
    misfit: Misfit, motion: xr.Dataset, point: np.ndarray, covariance: np.ndarray, distrust: float
) -> tuple[np.ndarray, np.ndarray]:
    """The parameters and their covariance after one run."""
    dynamics = LineDynamics(misfit, motion)
    count, known = dynamics.count, len(point)
    measured, own_noise = dynamics.measured(motion)
    noise = np.diag(own_noise**2 + (distrust * np.ptp(measured, axis=0)) ** 2)
    state = measured[0].copy()
    q = np.zeros((2 * count + known, 2 * count + known))
    q[: 2 * count, : 2 * count] = np.diag(own_noise**2)
    q[2 * count :, 2 * count :] = covariance
    lower, upper = misfit.bounds()
    observe = np.eye(2 * count, 2 * count + known)
    for step, reading in zip(np.diff(motion["time"].values), measured[1:], strict=True):
        state, transition = dynamics.advance(state, point, float(step))
        q = transition @ q @ transition.T
        gain = q @ observe.T @ np.linalg.inv(observe @ q @ observe.T + noise)
        change = gain @ (reading - state)
        q = (np.eye(len(q)) - gain @ observe) @ q
        q = 0.5 * (q + q.T)
        state, point = state + change[: 2 * count], np.clip(point + change[2 * count :], lower, upper)
    return point, q[2 * count :, 2 * count :]
