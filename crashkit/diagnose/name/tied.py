"""What had left as little as the first finding before a second was made, asked again beside that."""

from collections.abc import Sequence

from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.evidence import UNEXPLAINED, Rival, best_forms, is_unknown, ranked_by_evidence
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.forms import in_all_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared

TIED, UNSURE = 1.05, 2.0
"""Times what a finding alone leaves above the noise: what leaves no more was hardly told from it; and where both findings
together leave something, what may be told instead of one that is wrong."""
MOST = 2
"""How many such causes are asked again."""
RIVALS = 20.0
"""Log evidence by which one may fall behind and still is told as a rival."""


def untied(inquiry: Inquiry, findings: Sequence[Look], search: Search) -> tuple[list[Look], Search]:
    """The first of two findings, or what was hardly told from it while it had to make do for the second, too, in whatever form
    is most evident beside that; and the fit with both.

    Arguments:
        search: the fit with the findings.
    """
    first, *others = findings
    rivals = _tied(inquiry, first, search)
    if not rivals:
        return list(findings), search
    beside, without = [look.leader for look in others], search.deviance + first.leader.drop
    forms = [form for rival in rivals for form in in_all_forms(inquiry, rival, beside, search)]
    ranked = best_forms(ranked_by_evidence([Candidate(first.leader.proposal, search), *forms], without))
    close = [rival for rival in ranked if rival.evidence > ranked[0].evidence - RIVALS]
    if len(close) == 1 and close[0].identity == first.leader.identity:
        return list(findings), search
    return [compared(first, close), *others], close[0].search


def _tied(inquiry: Inquiry, look: Look, search: Search) -> list[Rival]:
    """The known rivals at the place of a finding, found when nothing else was, that leave hardly more than it does alone."""
    if look.before.names != inquiry.base.misfit.names:
        return []
    known = [rival for rival in look.rivals[1:] if not is_unknown(rival) and rival.place == look.leader.place]
    alone = inquiry.fit_with([look.leader], search) if known else None
    if alone is None:
        return []
    least = alone.excess * (TIED if search.normalised < UNEXPLAINED else UNSURE)
    return [rival for rival in known if rival.search.excess < least][:MOST]
