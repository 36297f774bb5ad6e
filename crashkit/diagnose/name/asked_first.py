"""A further run contradicts what was found: what came second may explain it, or what was found in other forms."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.fitting.evidence import (
    Rival,
    best_forms,
    explains,
    is_unknown,
    probabilities,
    ranked_by_evidence,
    rival_of,
)
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.forms import in_all_forms, in_best_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Round, between, look_again
from crashkit.diagnose.name.rivals import again
from crashkit.diagnose.name.rounds import Discovery, followed

MOST = 3
"""How many rivals are tried, the contradicted one among them: its other forms may explain more."""


def asked_first(inquiry: Inquiry, looks: Sequence[Round]) -> Discovery | None:
    """What these looks say of all runs, if it explains everything: the rivals of a single one, or the findings of several in
    other forms.

    Arguments:
        inquiry: into all runs.
        looks: as they were made without the run that contradicts the answer.
    """
    if len(looks) > 1:
        return _in_other_forms(inquiry, looks)
    rivals = [rival for look in looks for rival in look.rivals]
    return _second_best(inquiry, rivals)


def _in_other_forms(inquiry: Inquiry, looks: Sequence[Round]) -> Discovery | None:
    """The same findings, fitted to all runs, in the forms that suit these."""
    claims = [look.leader for look in looks]
    search = inquiry.fit_with(claims, claims[-1].search)
    if search is None:
        return None
    rounds = [_with_all_runs(inquiry, look, claims, search) for look in looks]
    rounds, search = in_best_forms(inquiry, rounds, search)
    return Discovery(inquiry.base.fitted(), search.fitted(), search, tuple(rounds)) if explains(search) else None


def _with_all_runs(inquiry: Inquiry, look: Round, claims: Sequence[Rival], search: Search) -> Round:
    """The look with its finding alone, fitted to all runs beside the others."""
    finding = look.leader
    others = [claim for claim in claims if claim is not finding]
    without = inquiry.fit_with(others, search) or inquiry.base
    again = rival_of(finding.proposal, search, without.deviance)
    return between(evolve(look, before=without.fitted(), couples=()), [again])


def _second_best(inquiry: Inquiry, rivals: Sequence[Rival]) -> Discovery | None:
    """The most evident of the named rivals in its best form, if it explains everything and nothing convinces beside it."""
    known = [rival for rival in rivals if not is_unknown(rival)][:MOST]
    fitted = [one for rival in known for one in _fitted(inquiry, rival)]
    if not fitted:
        return None
    leader = max(fitted, key=lambda rival: rival.evidence)
    forms = in_all_forms(inquiry, leader, [], leader.search)
    everything = [*fitted, *ranked_by_evidence(forms, inquiry.base.deviance)]
    ranked = best_forms(sorted(everything, key=lambda rival: -rival.evidence))
    if not explains(ranked[0].search):
        return None
    chances, nothing = probabilities(ranked, len(ranked))
    first = Round(tuple(ranked), tuple(chances.tolist()), nothing, inquiry.base.fitted())
    look = look_again(inquiry, ranked[0].search.fitted(), ranked[:1])
    found, _ = followed(inquiry, [first], look)
    return found if len(found.rounds) == 1 else None


def _fitted(inquiry: Inquiry, rival: Rival) -> list[Rival]:
    """A rival re-identified with all runs; none where it cannot be placed."""
    alone = inquiry.fit_with([rival], rival.search)
    if alone is None:
        return []
    alone = again(inquiry.workshop, inquiry.given, evolve(rival, search=alone), inquiry.progress)
    return [rival_of(rival.proposal, alone, inquiry.base.deviance)]
