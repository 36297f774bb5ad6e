"""A force of the time that leads a look, as one pulse: of all heights of a table over a run a short one takes one or two."""

from crashkit.diagnose.fitting.evidence import IN_TIME, UNEXPLAINED, best_forms, by_evidence, ranked_by_evidence
from crashkit.diagnose.name.imitate import begun_beside
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared
from crashkit.protocols import Proposal

PLACES = 3
"""At how many of the places where such tables leave least."""


def with_pulses(inquiry: Inquiry, look: Look) -> Look:
    """The look, if a table of the time leads it and leaves something, with a pulse at each place where one leaves little."""
    tables = [rival for rival in look.rivals if _is_table(rival.proposal)]
    if not tables or tables[0] is not look.leader or look.leader.search.normalised < UNEXPLAINED:
        return look
    nearest = sorted(tables, key=lambda rival: rival.search.deviance)[:PLACES]
    fitted = [one for table in nearest for one in begun_beside(inquiry, table, look.before, _is_pulse)]
    pulses = ranked_by_evidence(fitted, look.leader.without)
    return compared(look, best_forms(by_evidence([*look.rivals, *pulses])))


def _is_table(claim: Proposal) -> bool:
    return claim.estimate_of == IN_TIME and claim.form == IN_TIME


def _is_pulse(claim: Proposal) -> bool:
    return claim.estimate_of == IN_TIME and claim.form != IN_TIME
