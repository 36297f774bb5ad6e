"""Two causes at once, of those that lead alone or of all: together they may leave nothing, where each alone leaves much."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from crashkit.diagnose.claims import proposed_again
from crashkit.diagnose.fitting.couples import Couple, coupled, each_once, in_heats
from crashkit.diagnose.fitting.evidence import Rival, is_unknown
from crashkit.diagnose.fitting.regress import opened
from crashkit.diagnose.fitting.search import Search, begin
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import open_claims
from crashkit.misfit import Misfit

HEATS = ((None, 6), (4, 6), (2, 40))
"""How many couples enter each heat, and how many steps each gets there."""


def coupled_leaders(inquiry: Inquiry, leaders: Sequence[Rival]) -> list[Couple]:
    """The couples of claims that lead a look, the most evident first."""
    inquiry.progress(f"fitting {len(leaders)} claims beside each other", 0.0)
    return each_once(in_heats(list(_begun(inquiry, leaders)), HEATS))


def couples_from_given(inquiry: Inquiry, alone: Search) -> list[Couple]:
    """The couples of all causes, as the equations of motion tell them from the values that the user gave.

    Where one of two causes does for most of both, it leads alone, and those that lead next only do for its form.

    Arguments:
        alone: the fit with the best of them.
    """
    current = inquiry.base.fitted()
    given = current.with_values_of(inquiry.given)
    plain = [proposal for proposal in open_claims(inquiry, current, []) if not proposal.refined]
    equipped = inquiry.workshop.equipped([proposal.model for proposal in plain])
    ends = opened(equipped, given, plain, inquiry.progress)
    return coupled(equipped, given, plain, ends, alone.excess, inquiry.progress)


def _begun(inquiry: Inquiry, leaders: Sequence[Rival]) -> Iterator[Couple]:
    """Every two of them whose laws are compiled together; an estimate also from no force beside the one that leads."""
    for first, second in combinations(leaders, 2):
        alone = first.search.fitted()
        claim = proposed_again(inquiry.workshop, alone, second.proposal)
        if claim is not None and inquiry.workshop.holds(claim.model):
            misfit = inquiry.workshop.misfit(alone, claim.model).with_values_of(alone)
            starts = [_halfway(misfit, first.search.values, second.search.values), *([misfit] if is_unknown(second) else [])]
            for start in starts:
                yield Couple(first.proposal, claim, begin(inquiry.workshop.identifier, start))


def _halfway(misfit: Misfit, first: Mapping[str, float], second: Mapping[str, float]) -> Misfit:
    """Between where one cause alone has driven the model's numbers and where the other has: either made do for both."""
    ends = [misfit.start_at({**one, **other}) for one, other in ((first, second), (second, first))]
    return misfit.with_values(misfit.values(0.5 * (ends[0] + ends[1])))
