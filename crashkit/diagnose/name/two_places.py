"""Two estimates that lead point to two places: known causes imitate the one beside the other, and then that one as well."""

from collections.abc import Iterator

from crashkit.diagnose.claims import proposed_again
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.couples import Couple, each_once
from crashkit.diagnose.fitting.evidence import Rival, is_unknown
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.imitate import imitating
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.leaders import coupled_leaders
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.rivals import COUPLED
from crashkit.diagnose.result import place_of
from crashkit.protocols import Proposal

LEADING = 3
"""How many estimates that leave less than any known cause are put beside each other."""
LESS = 0.25
"""Of what one estimate alone leaves above the noise: two that leave more point to one place."""
KNOWN = 2
"""How many of the causes that imitate one of them are asked for a second one."""


def couples_at_two_places(inquiry: Inquiry, look: Look, alone: Search) -> list[Couple]:
    """The couples of known causes at the two places to which estimates point, the most evident first; none where they do not.

    Of two gross causes a known one alone has to make do for both, in a form that suits neither; an estimate is freer, and
    beside another one leaves next to nothing where both are right.

    Arguments:
        alone: the fit with the best known cause.
    """
    estimates = [rival for rival in look.rivals if is_unknown(rival) and rival.search.excess < alone.excess][:LEADING]
    pairs = coupled_leaders(inquiry, estimates)
    if not pairs:
        return []
    enough = min(COUPLED * alone.excess, LESS * estimates[0].search.excess)
    if pairs[0].search.excess > enough:
        return []
    return each_once(list(_named(inquiry, pairs[0])))


def _named(inquiry: Inquiry, pair: Couple) -> Iterator[Couple]:
    """Known causes instead of both estimates."""
    first, second = pair.first, _on_base(inquiry, pair.second)
    if second is None:
        return
    for known, search in _standing_for_one(inquiry, first, second, pair.search):
        left = second if place_of(known.location) == place_of(first.location) else first
        claim = _on_base(inquiry, known)
        if claim is not None:
            yield from (Couple(claim, *one) for one in _imitations(inquiry, left, claim, search))


def _standing_for_one(inquiry: Inquiry, first: Proposal, second: Proposal, pair: Search) -> list[Candidate]:
    """The best few known causes instead of the first estimate; where all of these leave more than it does, also instead of the
    second."""
    instead = _imitations(inquiry, first, second, pair)
    if all(one.search.excess > pair.excess for one in instead):
        instead += _imitations(inquiry, second, first, pair)
    return sorted(instead, key=lambda one: one.priced)[:KNOWN]


def _imitations(inquiry: Inquiry, estimate: Proposal, other: Proposal, search: Search) -> list[Candidate]:
    """Fits of the known causes at the place of an estimate beside another claim, both at the numbers of a fit."""
    beside = inquiry.workshop.equipped([other.model]).misfit(inquiry.base.misfit, other.model).with_values_of(search.fitted())
    claim = proposed_again(inquiry.workshop, beside, estimate)
    return imitating(inquiry, Rival(claim, search, 0.0, 0.0), beside) if claim else []


def _on_base(inquiry: Inquiry, claim: Proposal) -> Proposal | None:
    """The claim built on the model as it is; None where it is not made there, as some are only of certain motions."""
    return proposed_again(inquiry.workshop, inquiry.base.fitted(), claim)
