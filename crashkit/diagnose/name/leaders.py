"""Two causes at once, of those that lead alone: together they may leave nothing, where each alone leaves much."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from crashkit.diagnose.claims import proposed_again
from crashkit.diagnose.fitting.couples import Couple, each_once, in_heats
from crashkit.diagnose.fitting.evidence import Rival, is_unknown
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.misfit import Misfit

HEATS = ((None, 6), (4, 6), (2, 40))
"""How many couples enter each heat, and how many steps each gets there."""


def coupled_leaders(inquiry: Inquiry, leaders: Sequence[Rival]) -> list[Couple]:
    """The couples of claims that lead a look, the most evident first."""
    inquiry.progress(f"fitting {len(leaders)} claims beside each other", 0.0)
    return each_once(in_heats(list(_begun(inquiry, leaders)), HEATS))


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
