"""Where the equations of motion lead each claim along the motion that was measured, in which no error leads another astray."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from crashkit.campaign import spread
from crashkit.diagnose.claims import Progress, first_of_each
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.contest import heats
from crashkit.diagnose.fitting.continuation import grown
from crashkit.diagnose.fitting.evidence import explains
from crashkit.diagnose.fitting.search import Search, advance_all, begin_all
from crashkit.diagnose.result import UNKNOWN
from crashkit.diagnose.workshop import Workshop
from crashkit.errors import CrashkitError
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier, Proposal, advanced

ROUNDS = ((None, 4), (2, 25))
"""How many of the starts enter each round of a regression, and how many steps each gets there."""
OPENING = ((None, 2), (3, 2), (1, 6))
"""The same for each of many claims at first."""
CLAIMS = 48
"""How many of these go on."""
STEPS = 30
"""Of a search with simulations from there."""
AT_A_TIME = 4
"""How many searches take in the recordings little by little, which is slow, before it is asked whether that is enough."""
APART = 0.05
"""Of what a middling claim leaves above the noise: one that leaves less is where it belongs."""
HEATS = ((16, 10), (5, 60))
"""How many of the forms that leave least of the equations are simulated, and how many more steps each gets."""

End = tuple[Mapping[str, float], float]
"""Values by path, and what they leave of the equations."""


def opened(workshop: Workshop, given: Misfit, proposals: Sequence[Proposal], progress: Progress) -> list[End | None]:
    """Where a short regression of the measured accelerations leads each claim, with the model's own numbers.

    An acceleration depends on what acts on that body at that instant, and not on what was wrong before or elsewhere. None for
    a claim that has no such equation, as those about an instrument.
    """
    # This also measures the motion, before copies of this process would each do so.
    if regression(workshop, given) is None:
        return [None] * len(proposals)

    def end_of(proposal: Proposal) -> End | None:
        if workshop.hypotheses[proposal.physics].sensor:
            return None
        origin = workshop.misfit(given, proposal.model).with_values_of(given)
        return regression(workshop, origin, [{**proposal.null, **start} for start in proposal.starts], OPENING)

    def shown(done: int) -> None:
        progress(f"regressing the equations of motion for {len(proposals)} claims", done / len(proposals))

    # Bodies that nobody saw are simulated, which may take long: those come first, or one process waits for the other.
    order = sorted(range(len(proposals)), key=lambda one: -len(proposals[one].model.bodies))
    ends = dict(zip(order, spread(end_of, [proposals[one] for one in order], shown), strict=True))
    return [ends[one] for one in range(len(proposals))]


def regressed(
    workshop: Workshop, given: Misfit, proposals: Sequence[Proposal], ends: Sequence[End | None], progress: Progress
) -> list[Candidate]:
    """Searches from where longer regressions lead the claims that leave least of the equations.

    Arguments:
        ends: where short ones have led them.
    """

    def ended(claim: tuple[Proposal, End]) -> End | None:
        proposal, (values, _) = claim
        return regression(workshop, workshop.misfit(given, proposal.model).with_values(values))

    ahead = _ranked(proposals, ends)[:CLAIMS]
    ahead = _ranked([proposal for proposal, _ in ahead], spread(ended, ahead))[: HEATS[0][0]]
    starts = [workshop.misfit(given, proposal.model).with_values(values) for proposal, (values, _) in ahead]
    known = [proposal.physics != UNKNOWN for proposal, _ in ahead]
    doing = f"showing the recordings to {len(starts)} claims"
    searches = simulated(workshop.identifier, starts, known, lambda share: progress(doing, share))
    return heats([Candidate(proposal, search) for (proposal, _), search in zip(ahead, searches, strict=True)], HEATS, progress)


def simulated(
    identifier: Identifier[Any], starts: Sequence[Misfit], known: Sequence[bool], told: Callable[[float], None]
) -> list[Search]:
    """Searches with simulations from where the equations have led: at once, and until a known claim explains everything, a few
    at a time, little by little too; the better of both. Where one stands out after the first few, no others are.

    Arguments:
        told: the share that is done; where it raises, nothing more is.
    """
    told(0.0)
    searches = advance_all(begin_all(identifier, starts), STEPS)
    order = sorted(range(len(starts)), key=lambda one: (not known[one], searches[one].state.cost))
    for first in range(0, len(order), AT_A_TIME):
        named = [search for is_known, search in zip(known, searches, strict=True) if is_known]
        if any(map(explains, named)) or (first and _stands_out(named)):
            break
        told(first / len(order))
        few = order[first : first + AT_A_TIME]
        for one, search in zip(few, _by_and_by(identifier, [starts[one] for one in few]), strict=True):
            searches[one] = min(searches[one], search, key=lambda search: search.state.cost)
    return searches


def _stands_out(searches: Sequence[Search]) -> bool:
    """Whether one of these fits leaves next to nothing of what half of them do."""
    left = sorted(search.excess for search in searches)
    return len(left) > 1 and left[0] < APART * left[len(left) // 2]


def _by_and_by(identifier: Identifier[Any], starts: Sequence[Misfit]) -> list[Search]:
    """Searches that take in the recordings little by little.

    While little has been seen, all numbers are believed to be where the equations have led them: a claim about what comes late
    else loses its size before that is seen, and from nothing no search comes back.
    """
    shown = spread(lambda start: grown(identifier, start.with_prior(start.prior.std)), starts)
    ends = [start.with_values(values) for start, values in zip(starts, shown, strict=True)]
    return advance_all(begin_all(identifier, ends), STEPS)


def _ranked(proposals: Sequence[Proposal], ends: Sequence[End | None]) -> list[tuple[Proposal, End]]:
    """Each form of each claim at its best, those ahead that leave least of the equations."""
    ended = [(proposal, end) for proposal, end in zip(proposals, ends, strict=True) if end is not None]
    return first_of_each(sorted(ended, key=lambda claim: claim[1][1]), 1)


def regression(
    workshop: Workshop,
    misfit: Misfit,
    starts: Sequence[Mapping[str, float]] = ({},),
    rounds: Sequence[tuple[int | None, int]] = ROUNDS,
) -> End | None:
    """Where the best regression ends that begins at the values of a misfit, changed to one of these; None where there are no
    such equations."""
    starter = workshop.starter
    try:
        first = starter.start(misfit)
        states = [starter.moved(misfit, first, misfit.start_at(start)) if start else first for start in starts]
        for size, steps in rounds:
            states = [advanced(starter, misfit, one, steps) for one in sorted(states, key=lambda state: state.cost)[:size]]
    except CrashkitError:
        return None
    best = min(states, key=lambda state: state.cost)
    return misfit.values(best.point), best.cost


def residual_and_jacobian(workshop: Workshop, misfit: Misfit) -> tuple[np.ndarray, np.ndarray] | None:
    """What the equations leave at a model's own values, and its derivatives; None where there are no such equations."""
    try:
        state = workshop.starter.start(misfit)
        return workshop.starter.equations(misfit, state).residual_and_jacobian(misfit.start())
    except CrashkitError:
        return None
