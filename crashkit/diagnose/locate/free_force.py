"""Where one force would explain what the recordings show, whatever its law: its course in each run left open."""

from collections.abc import Sequence

import numpy as np
from attrs import frozen

from crashkit.campaign import spread
from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.result import place_of
from crashkit.diagnose.workshop import Workshop
from crashkit.errors import CrashkitError
from crashkit.misfit import Misfit, SameVariables
from crashkit.protocols import Problem, Proposal, advanced

IN_TIME = "time"
"""The heights of an estimated force that depends on it are taken as a course of its own in each run."""
STEPS = 30
PLAINLY = 0.6
"""Of what is left where it is left least but for one place: less than that is left at a place that stands out."""
SAME = 1e-3
"""By how much two places may differ that are one and the same."""


@frozen
class FreeForce:
    """A force of any course at one place.

    Attributes:
        proposal: the claim of a force of the time there.
        left: chi squared that it leaves of the equations of motion, with what was believed of the model's own numbers.
    """

    proposal: Proposal
    left: float

    @property
    def place(self) -> str:
        """Where, for people."""
        return place_of(self.proposal.location)


@frozen
class Pointer:
    """The one place that stands out, and the next best.

    Attributes:
        first, second: the courses there.
    """

    first: FreeForce
    second: FreeForce

    def __str__(self) -> str:
        first, second = (one.place for one in (self.first, self.second))
        return (
            f"the equations of motion point to {first}: a single force there, of another course in each run, would leave "
            f"{self.first.left / self.second.left:.0%} of what one at {second} would"
        )


def outstanding(found: Sequence[FreeForce]) -> Pointer | None:
    """The place that stands out, of courses that are sorted by what they leave; None where two leave about as much.

    Of places that leave the same, as a body and the only joint that holds it to the ground, the first speaks for all.
    """
    others = [one for one in found[1:] if one.left > (1.0 + SAME) * found[0].left]
    return Pointer(found[0], others[0]) if others and found[0].left < PLAINLY * others[0].left else None


def free_forces(workshop: Workshop, given: Misfit) -> list[FreeForce]:
    """Of every joint and body what a force of any course there would leave of the equations of motion, the least first.

    Along the measured motion this needs no law: whatever acts between two bodies accelerates just these two, and oppositely.

    Arguments:
        given: the misfit of the model at the values that the user gave.
    """
    try:
        workshop.locator.start(given)  # measures the motion, before copies of this process would each do so
    except CrashkitError:
        return []
    forces = [p for p in propose_all(workshop, given) if p.form == IN_TIME and p.estimate_of == IN_TIME]
    equipped = workshop.equipped([force.model for force in forces])
    found = spread(lambda force: _course(equipped, equipped.misfit(given, force.model), force), forces)
    return sorted((one for one in found if one is not None), key=lambda one: one.left)


def _course(workshop: Workshop, misfit: Misfit, force: Proposal) -> FreeForce | None:
    """None where what nobody saw cannot be simulated beside what was measured."""
    try:
        problem = _Free(workshop, misfit, force)
        state = advanced(workshop.identifier, problem, workshop.identifier.start(problem), STEPS)
    except CrashkitError:
        return None
    return FreeForce(force, 2.0 * float(state.cost))


class _Free(SameVariables):
    """The equations of motion of all runs without what a course of the force in each could explain.

    With B the derivatives of the residuals r to the heights of that course, the least of |r - B c| over c is |r - Q Q' r|, and
    the columns of Q span B (variable projection, Golub & Pereyra 1973, doi:10.1137/0710036, with the derivatives of Kaufman).
    The heights themselves stay at 0.
    """

    def __init__(self, workshop: Workshop, misfit: Misfit, force: Proposal) -> None:
        super().__init__(misfit)
        self._belief = misfit.belief
        self._heights = np.isin(misfit.names, force.parameters)
        self._runs = [_equations(workshop, misfit.with_recordings((run,))) for run in misfit.recordings]

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What is left of all runs, then what was believed of the numbers."""
        parts = [*(self._left(*run.residual_and_jacobian(scaled)) for run in self._runs), self._belief(scaled)]
        residual, jacobian = (np.concatenate(side) for side in zip(*parts, strict=True))
        return residual, jacobian * ~self._heights

    def _left(self, residual: np.ndarray, jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        course = jacobian[:, self._heights]
        size = np.linalg.norm(course, axis=0)
        basis, _ = np.linalg.qr(course[:, size > 0.0] / size[size > 0.0])
        return residual - basis @ (basis.T @ residual), jacobian - basis @ (basis.T @ jacobian)


def _equations(workshop: Workshop, misfit: Misfit) -> Problem:
    return workshop.locator.equations(misfit, workshop.locator.start(misfit))
