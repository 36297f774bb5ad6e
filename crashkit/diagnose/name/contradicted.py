"""A further run contradicts what was found: what came second may explain it, or what was found in other forms."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.fitting.evidence import (
    UNEXPLAINED,
    Rival,
    best_forms,
    by_evidence,
    explains,
    is_strained,
    is_unknown,
    ranked_by_evidence,
    rival_of,
)
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.explore import beside_reading
from crashkit.diagnose.name.follow import Discovery, followed, is_estimated, leave_no_third
from crashkit.diagnose.name.forms import in_all_forms, in_best_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared, is_exact, led, look_again
from crashkit.diagnose.name.pace import check_rate
from crashkit.diagnose.name.rivals import CONCEALED

MOST = 3
"""How many rivals are tried, the contradicted one among them: its other forms may explain more."""


def asked_first(inquiry: Inquiry, looks: Sequence[Look], stand: bool = False) -> Discovery | None:
    """What these looks say of all runs, if it explains everything: the rivals of a single one, or the findings of several in
    other forms, which may leave too little for another to be told. Beside one number of an instrument, what the structure
    lacks is asked at once.

    Arguments:
        inquiry: into all runs.
        looks: as they were made without the run that contradicts the answer.
        stand: whether none does, and several findings are only seen more finely: they may be all but one.
    """
    if len(looks) > 1:
        return _in_other_forms(inquiry, looks, stand)
    rivals = [rival for look in looks for rival in look.rivals]
    if rivals and is_exact(rivals[0].proposal):
        return _beside_number(inquiry, looks[0])
    return _second_best(inquiry, rivals)


def _in_other_forms(inquiry: Inquiry, looks: Sequence[Look], stand: bool) -> Discovery | None:
    """The same findings, fitted to all runs, in the forms that suit these; if they stand, with what is found beside them."""
    claims = [look.leader for look in looks]
    search = inquiry.fit_with(claims, claims[-1].search)
    if search is None:
        return None
    findings = [_with_all_runs(inquiry, look, claims, search) for look in looks]
    findings, search = in_best_forms(inquiry, findings, search)
    is_little = leave_no_third(findings, search, inquiry.base) and not is_strained(search)
    if explains(search) or is_little:
        return Discovery.of(inquiry.base, search, tuple(findings))
    return _gone_on(inquiry, findings, search) if stand else None


def _gone_on(inquiry: Inquiry, findings: Sequence[Look], search: Search) -> Discovery | None:
    """The findings with what is found beside them, each questioned in the light of the others; None if that leaves much."""
    look = look_again(inquiry, search.fitted(), [one.leader for one in findings])
    found, _ = followed(inquiry, findings, look)
    return found if found.search.normalised < UNEXPLAINED else None


def _with_all_runs(inquiry: Inquiry, look: Look, claims: Sequence[Rival], search: Search) -> Look:
    """The look with its finding alone, fitted to all runs beside the others."""
    finding = look.leader
    others = [claim for claim in claims if claim is not finding]
    without = inquiry.fit_with(others, search) or inquiry.base
    again = rival_of(finding.proposal, search, without.deviance)
    return compared(evolve(look, before=without.fitted(), couples=()), [again])


def _beside_number(inquiry: Inquiry, look: Look) -> Discovery | None:
    """What all runs say beside one number of an instrument, which has no other form."""
    claim = look.leader
    search = inquiry.fit_with([claim], claim.search)
    if search is None:
        return None
    again = rival_of(claim.proposal, search, inquiry.base.deviance)
    check_rate(inquiry, again)
    return beside_reading(inquiry, look.led_by(again))


def _second_best(inquiry: Inquiry, rivals: Sequence[Rival]) -> Discovery | None:
    """The most evident of the named rivals in its best form, if it explains everything and nothing convinces beside it."""
    ranked = _ranked(inquiry, rivals)
    if not ranked or not explains(ranked[0].search):
        return None
    look = look_again(inquiry, ranked[0].search.fitted(), ranked[:1])
    found, _ = followed(inquiry, [Look.of(ranked, inquiry.base.fitted())], look)
    return found if len(found.findings) == 1 else None


def named_nevertheless(inquiry: Inquiry, looks: Sequence[Look], found: Discovery) -> Discovery:
    """What was found in all runs; or, where that is an estimate at the place of what explains all but one of them, that, if it
    leaves little of all.

    A form that is off by that much is told better with its name than as a table.
    """
    if len(looks) != 1 or not is_estimated(found.findings):
        return found
    first, estimate = looks[0].leader, found.findings[-1].leader
    if is_unknown(first) or first.place != estimate.place:
        return found
    ranked = _ranked(inquiry, [first])
    if not ranked or ranked[0].search.normalised > CONCEALED:
        return found
    told = led(Look.of([*ranked, estimate], inquiry.base.fitted()))
    return Discovery.of(inquiry.base, ranked[0].search, (told,))


def _ranked(inquiry: Inquiry, rivals: Sequence[Rival]) -> list[Rival]:
    """The named ones among these, re-identified with all runs, the most evident in its best form; it comes first."""
    known = [rival for rival in rivals if not is_unknown(rival)][:MOST]
    fitted = [one for rival in known for one in _fitted(inquiry, rival)]
    if not fitted:
        return []
    leader = max(fitted, key=lambda rival: rival.evidence)
    forms = in_all_forms(inquiry, leader, [], leader.search)
    everything = [*fitted, *ranked_by_evidence(forms, inquiry.base.deviance)]
    return best_forms(by_evidence(everything))


def _fitted(inquiry: Inquiry, rival: Rival) -> list[Rival]:
    """A rival re-identified with all runs; none where it cannot be placed."""
    alone = inquiry.fit_with([rival], rival.search)
    if alone is None:
        return []
    alone = inquiry.again(evolve(rival, search=alone))
    return [rival_of(rival.proposal, alone, inquiry.base.deviance)]
