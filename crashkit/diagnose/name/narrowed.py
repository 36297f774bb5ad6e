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
from crashkit.diagnose.name.follow import NEEDED
from crashkit.diagnose.name.imitate import begun_beside
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared
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
    table = look.leader
    bumps = ranked_by_evidence(begun_beside(inquiry, table, look.before, _is_bump), table.without)
    if not bumps or not _explains_what_is_left(bumps[0], known):
        return None
    led_by_bump = compared(look, [bumps[0], *(rival for rival in look.rivals if rival.identity != table.identity)])
    return None if named_instead(inquiry, led_by_bump, bumps[0]) else led_by_bump


def _explains_what_is_left(bump: Rival, known: Rival) -> bool:
    return explains(bump.search) and known.search.deviance - bump.search.deviance > NEEDED


def _is_bump(claim: Proposal) -> bool:
    return _is_of_deformation(claim) and claim.refined


def _is_of_deformation(claim: Proposal) -> bool:
    return claim.estimate_of in OF_DEFORMATION


def _is_table(claim: Proposal) -> bool:
    return claim.estimate_of == IN_TIME and claim.form == IN_TIME


def _is_pulse(claim: Proposal) -> bool:
    return claim.estimate_of == IN_TIME and claim.form != IN_TIME
