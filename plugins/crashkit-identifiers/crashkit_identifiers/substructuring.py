"""Substructuring: one body with its joints at a time, and then all that they say together."""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve, field, frozen

from crashkit.misfit import Misfit
from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit_identifiers.cost import cost_at
from crashkit_identifiers.levenberg_marquardt import Limits, Search, advance, begin
from crashkit_identifiers.measured import measured_motions, require_seen
from crashkit_identifiers.parabola import modes
from crashkit_identifiers.recorded import engine_of, with_recordings
from crashkit_identifiers.result import Path, conclude
from crashkit_identifiers.substructure import Substructure

FURTHEST = 10.0
"""That the joined parts move the logarithm of a parameter."""
UNKNOWN = 1e-9
"""Share of the largest curvature below which a combination of parameters stays at its start."""


@frozen(eq=False)
class Testimony:
    """What one body said: places of its parameters, where its search ended, and the curvature there."""

    places: tuple[int, ...]
    point: np.ndarray
    curvature: np.ndarray
    status: Status


@frozen(eq=False)
class SubstructuringState:
    """The search of the body in hand, the parts that are done, and the measured motion of each run."""

    point: np.ndarray
    cost: float
    status: Status
    measured: Mapping[str, xr.Dataset]
    search: Search
    parts: tuple[Testimony, ...] = field(default=())
    path: Path = field(default=())


@frozen
class Substructuring(Identifier[SubstructuringState]):
    """Each body alone, its neighbours moving as they were measured (Mizzi & Jezequel 1992, section 4.3.4, Fig 16).

    A body's few parameters are found by the sensitivity method. Two bodies that share a joint both speak of it, and a body of
    unknown mass tells only the ratio of its forces to that mass: so all parts are joined by their curvatures,

    (Σ H_b) u = Σ H_b u_b.

    Every body that a joint holds must be seen by an instrument. The noise of the neighbours' motion is taken for motion, which
    biases the result a little; it starts other methods well.

    Arguments:
        step_limit: steps for each body.
    """

    name: ClassVar[str] = "substructuring"
    step_limit: int = 60

    def start(self, problem: Problem) -> SubstructuringState:
        """The state at the problem's own start, the first body in hand."""
        misfit = with_recordings(problem, self.name)
        measured = measured_motions(misfit)
        require_seen(misfit, measured, self.name)
        point = np.clip(misfit.start(), *misfit.bounds())
        cost = cost_at(misfit, point)
        search = begin(_substructure(misfit, measured, 0))
        path = ((cost, misfit.parameters(point)),)
        return SubstructuringState(point, cost, Status.RUNNING, measured, search, path=path)

    def step(self, problem: Problem, state: SubstructuringState) -> SubstructuringState:
        """One step of the body in hand; when it has ended, the next body; at last all of them together."""
        if state.status is not Status.RUNNING:
            return state
        misfit = with_recordings(problem, self.name)
        part = _substructure(misfit, state.measured, len(state.parts))
        search = advance(part, state.search, Limits(tolerance=1e-8, steps=self.step_limit))
        if search.status is Status.RUNNING:
            return evolve(state, search=search)
        done = (*state.parts, Testimony(tuple(part.places), search.point, search.curvature, search.status))
        point = np.clip(_joined(misfit, state.point, done), *misfit.bounds())
        cost = cost_at(misfit, point)
        state = evolve(state, parts=done, point=point, cost=cost, path=(*state.path, (cost, misfit.parameters(point))))
        if len(done) < len(_moving(misfit)):
            return evolve(state, search=begin(_substructure(misfit, state.measured, len(done))))
        ends = [one.status for one in done if one.status is not Status.CONVERGED]
        return evolve(state, status=ends[0] if ends else Status.CONVERGED)

    def finish(self, problem: Problem, state: SubstructuringState) -> Identification:
        """The parameters, with what the recordings of all bodies together say of them."""
        return conclude(problem, state.point, state.status, state.path)


def _moving(misfit: Misfit) -> list[str]:
    """The bodies that forces move, and that a joint holds."""
    held = {body for joint in misfit.model.joints for body in joint.pushed}
    return [body.name for body in misfit.model.bodies if body.name in held and body.is_free]


def _substructure(misfit: Misfit, measured: Mapping[str, xr.Dataset], number: int) -> Substructure:
    return Substructure(misfit, measured, _moving(misfit)[number], engine_of(misfit))


def _joined(misfit: Misfit, start: np.ndarray, parts: tuple[Testimony, ...]) -> np.ndarray:
    """The point that all parts agree on best, within what numbers can hold; what none of them sees stays where one ended."""
    curvature, pull, agreed = np.zeros((len(start), len(start))), np.zeros(len(start)), start.copy()
    for part in parts:
        agreed[list(part.places)] = part.point
    for part in parts:
        places = list(part.places)
        curvature[np.ix_(places, places)] += part.curvature
        pull[places] += part.curvature @ (part.point - agreed[places])
    felt = np.flatnonzero(np.diag(curvature) > 0.0)
    root, eigenvalues, vectors = modes(curvature[np.ix_(felt, felt)])
    seen = eigenvalues > UNKNOWN * eigenvalues.max(initial=0.0)
    agreed[felt] += vectors[:, seen] @ (vectors[:, seen].T @ (pull[felt] / root) / eigenvalues[seen]) / root
    room = np.where(misfit.scaling(start) != 1.0, FURTHEST, np.inf)
    return np.asarray(np.clip(agreed, start - room, start + room))
