"""From many claims to the few that fit: a score for all, a quick search for the promising, long ones for those ahead."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from crashkit.campaign import spread
from crashkit.diagnose.claims import Progress, Start, first_of_each, identity
from crashkit.diagnose.fitting.candidates import Candidate, advance_candidates, begin_candidates, weigh_candidates
from crashkit.diagnose.fitting.quadratic import Extended, tangent
from crashkit.diagnose.fitting.score import Score, score
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.result import UNKNOWN, place_of
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

GROWING = (1 / 3, 2 / 3, 1.0)
"""Shares of the time recorded that are looked at one after the other where a search begins far from the recordings."""
SCOUTING = 5
"""Steps of a quick search in each."""


def scores(
    workshop: Workshop, origin: Misfit, proposals: Sequence[Proposal], reference: float, progress: Progress
) -> list[tuple[Proposal, Score]]:
    """Of every proposal from each of its starts, the model's own parameters at their values in `origin`."""
    known = tangent(origin, origin.start())

    def scored(proposal: Proposal) -> list[Score | None]:
        misfit = workshop.misfit(origin, proposal.model).with_values_of(origin)
        extended = Extended(misfit, proposal.parameters, known)
        return [score(proposal, start, extended, reference) for start in proposal.starts]

    def told(done: int) -> None:
        progress(f"scoring {proposals[done].physics} at {place_of(proposals[done].location)}", done / len(proposals))

    found = zip(proposals, spread(scored, proposals, told), strict=True)
    return [(proposal, one) for proposal, each in found for one in each if one is not None]


def promising(scored: Sequence[tuple[Proposal, Score]], most: int, least: Callable[[Proposal], float]) -> list[Start]:
    """The best starts of every form of every claim that promises the drop that is asked of it."""
    hopeful = [(proposal, one) for proposal, one in scored if one.drop > least(proposal) or not proposal.null]
    best = first_of_each(sorted(hopeful, key=lambda one: -one[1].drop), most)
    return [(proposal, one.values) for proposal, one in best]


def scouted(
    workshop: Workshop,
    origin: Misfit,
    starts: Sequence[Start],
    shares: Sequence[float],
    most: int,
    astray: float,
    progress: Progress,
) -> list[Candidate]:
    """Searches from where quick ones at few instants end, of which the best go on.

    Arguments:
        shares: of the time recorded, looked at one after the other. Where they grow, a search seldom jumps over a threshold;
            instruments have none.
        most: how many go on.
        astray: cost at few instants above which slices of time have led a search astray, and one of all the time is tried.
    """
    slices = [early for early in (origin.coarse.up_to(share) for share in shares) if early.groups]

    def ahead_of(start: Start) -> tuple[Mapping[str, float], float]:
        proposal, values = start
        if workshop.hypotheses[proposal.physics].sensor or len(slices) == 1:
            return _scout(workshop, proposal, values, slices[-1:])
        end = _scout(workshop, proposal, values, slices)
        if end[1] < astray:
            return end
        return min(end, _scout(workshop, proposal, values, slices[-1:] * 2), key=lambda one: one[1])

    told = partial(_told, progress, [proposal for proposal, _ in starts])
    found = zip(starts, spread(ahead_of, starts, told), strict=True)
    ahead = sorted(((proposal, *end) for (proposal, _), end in found), key=lambda one: one[2])[:most]
    misfits = [workshop.misfit(origin, proposal.model).with_values(values) for proposal, values, _ in ahead]
    return begin_candidates(workshop.identifier, [proposal for proposal, *_ in ahead], misfits)


def _scout(
    workshop: Workshop, proposal: Proposal, values: Mapping[str, float], route: Sequence[Misfit]
) -> tuple[Mapping[str, float], float]:
    """Where a quick search ends that takes one slice of the recordings after the other, and what it leaves there."""
    for slice_ in route:
        misfit = workshop.misfit(slice_, proposal.model).with_values(values)
        search = begin(workshop.identifier, misfit).advance(SCOUTING)
        values = misfit.values(search.point)
    return values, search.state.cost


def heats(candidates: Sequence[Candidate], sizes: Sequence[tuple[int, int]], progress: Progress) -> list[Candidate]:
    """Successive halving: a few steps for all, then many steps for the few that are ahead, weighed by what each leaves.

    Arguments:
        sizes: how many enter each heat, and how many steps each gets there.
    """
    for size, steps in sizes:
        ahead = _ahead(candidates, size)
        candidates = advance_candidates(ahead, steps, partial(_told, progress, [one.proposal for one in ahead]))
    return weigh_candidates(candidates)


def _ahead(candidates: Sequence[Candidate], size: int) -> list[Candidate]:
    """The best of them; half the places are kept from estimated tables, whose many heights fit better than they explain.

    Whatever its forms, one claim does not take more than half of the others: the next ones may only be in a poorer form.
    """
    ranked = sorted(candidates, key=lambda one: one.priced)
    tables = [one for one in ranked if one.proposal.physics == UNKNOWN][: size // 2]
    named = [one for one in ranked if one.proposal.physics != UNKNOWN]
    places = size - len(tables)
    first = first_of_each(named, max(1, places // 2), identity)
    rest = [one for one in named if not any(one is other for other in first)]
    return [*[*first, *rest][:places], *tables]


def _told(progress: Progress, proposals: Sequence[Proposal], done: int) -> None:
    progress(f"fitting {proposals[done].physics} at {place_of(proposals[done].location)}", done / len(proposals))
