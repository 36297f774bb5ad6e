"""Two causes at once, where each alone leaves much: of those that lead, or one that leads and what may give way beside it."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import partial
from itertools import combinations

from crashkit.campaign import spread
from crashkit.diagnose.claims import proposed_again
from crashkit.diagnose.fitting.continuation import grown
from crashkit.diagnose.fitting.couples import Couple, each_once, in_heats
from crashkit.diagnose.fitting.evidence import Rival, is_unknown
from crashkit.diagnose.fitting.search import Search, begin, begin_all
from crashkit.diagnose.name.forms import in_all_forms, with_form
from crashkit.diagnose.name.inquiry import Inquiry, open_claims
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

HEATS = ((None, 6), (4, 6), (2, 40))
"""How many couples enter each heat, and how many steps each gets there."""
HOPEFUL = 0.25
"""Of what one cause alone leaves above the noise: two that leave less may leave nothing in other forms."""


def coupled_leaders(inquiry: Inquiry, leaders: Sequence[Rival]) -> list[Couple]:
    """The couples of claims that lead a look, the most evident first."""
    inquiry.progress(f"fitting {len(leaders)} claims beside each other", 0.0)
    return each_once(in_heats(list(_begun(inquiry, leaders)), HEATS))


def in_other_forms(inquiry: Inquiry, couples: Sequence[Couple], alone: Search) -> list[Couple]:
    """The couples that leave far less than one cause alone, each with its second claim in all forms, the most evident first.

    Which two they are shows only there: in plain forms that are off, the wrong two leave least.

    Arguments:
        alone: the fit with the best cause alone.
    """
    hopeful = [couple for couple in couples if couple.search.excess < HOPEFUL * alone.excess]
    return each_once([other for couple in hopeful for other in _with_second_in_all_forms(inquiry, couple)])


def beside_what_gives_way(inquiry: Inquiry, first: Rival) -> list[Couple]:
    """A first cause with each claim that sets free what the model holds fast, the most evident first.

    Nobody saw that move: no equation of its motion was measured, and no derivative where it is at rest tells how it goes. So
    they take in the recordings little by little, from the given numbers.
    """
    alone, held = first.search.fitted(), {body.name for body in inquiry.given.model.bodies if body.fixed}
    claims = [p for p in open_claims(inquiry, alone, [first]) if not p.refined and _sets_free(p, held)]
    equipped = inquiry.workshop.equipped([claim.model for claim in claims])
    own = {path: first.search.values[path] for path in first.proposal.parameters}
    origin = alone.with_values_of(inquiry.given).with_values(own)
    starts = [(claim, {**claim.null, **start}) for claim in claims for start in claim.starts]
    misfits = [with_form(equipped, origin, *start) for start in starts]
    told = partial(inquiry.progress, f"taking in the recordings with {first.proposal.physics} and what gives way")
    ends = spread(partial(grown, equipped.identifier), misfits, lambda done: told(done / len(misfits)))
    searches = begin_all(equipped.identifier, [one.with_values(end) for one, end in zip(misfits, ends, strict=True)])
    couples = [Couple(first.proposal, claim, search) for (claim, _), search in zip(starts, searches, strict=True)]
    return each_once(in_heats(couples, HEATS))


def _sets_free(claim: Proposal, held: Collection[str]) -> bool:
    return any(body.name in held and not body.fixed for body in claim.model.bodies)


def _with_second_in_all_forms(inquiry: Inquiry, couple: Couple) -> list[Couple]:
    first, second = (Rival(claim, couple.search, 0.0, 0.0) for claim in (couple.first, couple.second))
    return [Couple(couple.first, *fitted) for fitted in in_all_forms(inquiry, second, [first], couple.search)]


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
