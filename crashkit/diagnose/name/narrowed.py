"""An estimated force that leads a look, as one pulse of the time or one bump over the deformation, which has few numbers."""

from crashkit.diagnose.fitting.evidence import (
    IN_TIME,
    OF_DEFORMATION,
    UNEXPLAINED,
    Rival,
    best_forms,
    by_evidence,
    explains,
    is_unknown,
    ranked_by_evidence,
)
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.follow import NEEDED, Discovery
from crashkit.diagnose.name.imitate import begun_beside
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared, led
from crashkit.diagnose.name.pairs import named_instead
from crashkit.protocols import Proposal

PLACES = 3
"""At how many of the places where such tables leave least."""


def with_pulses(inquiry: Inquiry, look: Look) -> Look:
    """The look, if a table of the time leads it and leaves something, with a pulse at each place where one leaves little.

    Of all heights of a table over a run a short one takes one or two.
    """
    tables = [rival for rival in look.rivals if _is_table(rival.proposal)]
    if not tables or tables[0] is not look.leader or look.leader.search.normalised < UNEXPLAINED:
        return look
    nearest = sorted(tables, key=lambda rival: rival.search.deviance)[:PLACES]
    fitted = [one for table in nearest for one in begun_beside(inquiry, table, look.before, _is_pulse)]
    pulses = ranked_by_evidence(fitted, look.leader.without)
    return compared(look, best_forms(by_evidence([*look.rivals, *pulses])))


def as_bump(inquiry: Inquiry, look: Look) -> Look | None:
    """The look, if a table of the deformation leads it, led by one bump there instead, if that explains everything and known
    causes do not; else None.

    At the place of the best known cause two such together have about as many numbers as they need to follow a table.
    """
    known = next((rival for rival in look.rivals if not is_unknown(rival)), None)
    if known is None or not _is_of_deformation(look.leader.proposal) or known.place != look.leader.place:
        return None
    led_by_bump = _led_by_bump(inquiry, look, look.leader, known.search)
    return None if led_by_bump is None or named_instead(inquiry, led_by_bump, led_by_bump.leader) else led_by_bump


def in_one_bump(inquiry: Inquiry, found: Discovery) -> Discovery:
    """What was found; or, where that is one known cause which in its best form leaves something that a table of the
    deformation at its place does not, one bump there instead, if that explains everything.

    A dent in a plateau looks like a fracture as long as hardly any run goes beyond it.
    """
    if len(found.findings) != 1 or explains(found.search):
        return found
    look = found.findings[0]
    others = (*look.rivals[1:], *look.estimates)
    table = next((one for one in others if _is_of_deformation(one.proposal) and one.place == look.leader.place), None)
    if is_unknown(look.leader) or table is None or found.search.deviance - table.search.deviance < NEEDED:
        return found
    told = _led_by_bump(inquiry, look, table, found.search)
    return Discovery.of(inquiry.base, told.leader.search, (told,), found.last) if told else found


def _led_by_bump(inquiry: Inquiry, look: Look, table: Rival, known: Search) -> Look | None:
    """The look led by one bump instead of a table, if that explains everything that the best known cause leaves."""
    bumps = ranked_by_evidence(begun_beside(inquiry, table, look.before, _is_bump), table.without)
    if not bumps or not explains(bumps[0].search) or known.deviance - bumps[0].search.deviance < NEEDED:
        return None
    return led(compared(look, [bumps[0], *(rival for rival in look.rivals if rival.identity != table.identity)]))


def _is_bump(claim: Proposal) -> bool:
    return _is_of_deformation(claim) and claim.refined


def _is_of_deformation(claim: Proposal) -> bool:
    return claim.estimate_of in OF_DEFORMATION


def _is_table(claim: Proposal) -> bool:
    return claim.estimate_of == IN_TIME and claim.form == IN_TIME


def _is_pulse(claim: Proposal) -> bool:
    return claim.estimate_of == IN_TIME and claim.form != IN_TIME
