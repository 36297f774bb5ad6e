"""Two causes of one number each in the place of one of many: a law with many numbers imitates them."""

from attrs import evolve

from crashkit.diagnose.claims import accuses_instrument, is_same, price_of
from crashkit.diagnose.fitting.candidates import begin_candidates
from crashkit.diagnose.fitting.contest import heats
from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.fitting.evidence import Rival, is_unknown
from crashkit.diagnose.name.follow import TIE, Discovery
from crashkit.diagnose.name.forms import with_form
from crashkit.diagnose.name.inquiry import Inquiry, open_claims
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.pairs import both

MANY = 4
"""Numbers of a law that two claims of one number may stand behind."""
LEADERS = 4
"""How many of the claims of one number each may be first."""
HEATS = ((24, 6), (6, 10), (2, 40))
"""How many couples with each first claim enter each, and how many steps each gets there."""


def in_fewer_numbers(inquiry: Inquiry, found: Discovery) -> Discovery:
    """What was found; or two causes of one number each, if they are more evident than the one of many that was found.

    Alone each of them may leave far more than that, so that neither is followed.
    """
    if len(found.findings) != 1 or is_unknown(found.findings[0].leader):
        return found
    look = found.findings[0]
    if len(look.leader.proposal.parameters) < MANY:
        return found
    couple = _best_couple(inquiry, look)
    if couple is None or not _is_more_evident(couple, look.leader):
        return found
    two = both(inquiry, evolve(look, couples=(couple,)))
    if two is None or two[0].winner is None:
        return found
    search = two[1].leader.search
    return evolve(found, final=search.fitted(), search=search, findings=two)


def _is_more_evident(couple: Couple, one: Rival) -> bool:
    """Whether two claims explain more for their numbers than one, in deviance, as each has open noise levels of its own."""
    samples = one.search.misfit.independent_samples
    saved = price_of(one.proposal, samples) - price_of(couple.first, samples) - price_of(couple.second, samples)
    return couple.search.deviance < one.search.deviance + saved - TIE


def _best_couple(inquiry: Inquiry, look: Look) -> Couple | None:
    """The couple of the look's rivals of one number that leaves least; None if there is none."""
    plain = [rival for rival in look.rivals if len(rival.proposal.parameters) == 1 and not accuses_instrument(rival.proposal)]
    couples = [couple for first in plain[:LEADERS] for couple in _couples_with(inquiry, first, plain)]
    return min(couples, key=lambda couple: couple.search.deviance, default=None)


def _couples_with(inquiry: Inquiry, first: Rival, plain: list[Rival]) -> list[Couple]:
    """The fits of all the others beside the first."""
    alone = first.search.fitted()
    open_ = [p for p in open_claims(inquiry, alone, [first]) if any(is_same(p, rival.proposal) for rival in plain)]
    workshop = inquiry.workshop.equipped([claim.model for claim in open_])
    starts = [(claim, start) for claim in open_ for start in claim.starts]
    misfits = [with_form(workshop, alone, claim, start) for claim, start in starts]
    begun = begin_candidates(workshop.identifier, [claim for claim, _ in starts], misfits)
    return [Couple(first.proposal, *fitted) for fitted in heats(begun, HEATS, inquiry.progress)]
