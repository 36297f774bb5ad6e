"""A force in one joint that another joint's deformation drives, asked for where everything else leaves something."""

from attrs import evolve

from crashkit.diagnose.fitting.contest import propose_all
from crashkit.diagnose.fitting.evidence import FAR_LESS, UNEXPLAINED, Rival, best_forms, ranked_by_evidence
from crashkit.diagnose.fitting.regress import opened, regressed
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import compared, is_of_readings, led
from crashkit.diagnose.result import UNKNOWN


def linked_instead(inquiry: Inquiry, found: Discovery) -> Discovery:
    """What was found; or, where that plainly leaves something, an estimate of such a force that leaves far less.

    What acts at another place, or goes with another motion, imitates it badly, and the other way round. About instruments that
    are wrong the equations of motion, along which it is looked for, say nothing.
    """
    claims = [look.leader for look in found.findings]
    if not claims or found.search.normalised < UNEXPLAINED or any(is_of_readings(claim.proposal) for claim in claims):
        return found
    forms = _forces(inquiry)
    if not forms or forms[0].search.excess > FAR_LESS * found.search.excess:
        return found
    told = found.findings[0]
    others = [rival for rival in told.rivals if rival.identity not in {form.identity for form in forms}]
    first = compared(evolve(told, before=inquiry.base.fitted()), [*forms, *(others if len(found.findings) == 1 else [])])
    return Discovery(found.base, forms[0].search.fitted(), forms[0].search, (led(first),))


def _forces(inquiry: Inquiry) -> list[Rival]:
    """The best such force of each joint, the most evident first."""
    proposals = [p for p in propose_all(inquiry.workshop, inquiry.given) if p.physics == UNKNOWN and p.refined]
    equipped = inquiry.workshop.equipped([proposal.model for proposal in proposals])
    ends = opened(equipped, inquiry.given, proposals, inquiry.progress)
    fitted = regressed(equipped, inquiry.given, proposals, ends, inquiry.progress)
    return best_forms(ranked_by_evidence(fitted, inquiry.base.deviance))
