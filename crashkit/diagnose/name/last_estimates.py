"""Estimates asked for where everything else leaves something: a narrow bump, a pulse, or what another joint drives."""

from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import FAR_LESS, Rival, best_forms, ranked_by_evidence
from crashkit.diagnose.fitting.regress import opened, regressed
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import compared, led


def estimated_at_last(inquiry: Inquiry, found: Discovery) -> Discovery:
    """What was found; or, where that leaves something of the structure, such an estimate that leaves far less.

    What acts at another place, or goes with another motion, imitates it badly, and the other way round.
    """
    if not found.leaves_structure:
        return found
    estimates = _estimates(inquiry)
    if not estimates or estimates[0].search.excess > FAR_LESS * found.search.excess:
        return found
    told = found.findings[0]
    others = [rival for rival in told.rivals if rival.identity not in {one.identity for one in estimates}]
    first = compared(evolve(told, before=inquiry.base.fitted()), [*estimates, *(others if len(found.findings) == 1 else [])])
    return Discovery(found.base, estimates[0].search.fitted(), estimates[0].search, (led(first),))


def _estimates(inquiry: Inquiry) -> list[Rival]:
    """The best such force of each joint, the most evident first."""
    proposals = [p for p in propose_all(inquiry.workshop, inquiry.given) if p.estimate_of and p.refined]
    equipped = inquiry.workshop.equipped([proposal.model for proposal in proposals])
    ends = opened(equipped, inquiry.given, proposals, inquiry.progress)
    fitted = regressed(equipped, inquiry.given, proposals, ends, inquiry.progress)
    return best_forms(ranked_by_evidence(fitted, inquiry.base.deviance))
