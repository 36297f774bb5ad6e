"""A further run contradicts what was found: what came second may explain it, or what was found in other forms."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.fitting.contest import Progress
from crashkit.diagnose.fitting.evidence import (
    Rival,
    best_forms,
    explains,
    is_unknown,
    probabilities,
    ranked_by_evidence,
    rival_of,
)
from crashkit.diagnose.fitting.rebuild import rebuild
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.forms import in_all_forms, in_best_forms
from crashkit.diagnose.name.look import Round, between, look_again
from crashkit.diagnose.name.rivals import again
from crashkit.diagnose.name.rounds import Discovery, followed
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit

MOST = 3
"""How many rivals are tried, the contradicted one among them: its other forms may explain more."""


def asked_first(
    workshop: Workshop, given: Misfit, base_search: Search, looks: Sequence[Round], progress: Progress
) -> Discovery | None:
    """What these looks say of all runs, if it explains everything: the rivals of a single one, or the findings of several in
    other forms.

    Arguments:
        base_search: the best fit of the model without them, to all runs.
        looks: as they were made without the run that contradicts the answer.
    """
    if len(looks) > 1:
        return _in_other_forms(workshop, base_search, looks, progress)
    rivals = [rival for look in looks for rival in look.rivals]
    return _second_best(workshop, given, base_search, rivals, progress)


def _in_other_forms(workshop: Workshop, base_search: Search, looks: Sequence[Round], progress: Progress) -> Discovery | None:
    """The same findings, fitted to all runs, in the forms that suit these."""
    claims = [look.rivals[0] for look in looks]
    search = rebuild(workshop, base_search, claims, claims[-1].search)
    if search is None:
        return None
    rounds = [_with_all_runs(workshop, base_search, look, claims, search) for look in looks]
    rounds, search = in_best_forms(workshop, base_search, rounds, search, progress)
    return Discovery(base_search.fitted(), search.fitted(), search, tuple(rounds)) if explains(search) else None


def _with_all_runs(workshop: Workshop, base_search: Search, look: Round, claims: Sequence[Rival], search: Search) -> Round:
    """The look with its finding alone, fitted to all runs beside the others."""
    finding = look.rivals[0]
    others = [claim for claim in claims if claim is not finding]
    without = rebuild(workshop, base_search, others, search) or base_search
    again = rival_of(finding.proposal, search, without.deviance)
    return between(evolve(look, before=without.fitted(), couples=()), [again])


def _second_best(
    workshop: Workshop, given: Misfit, base_search: Search, rivals: Sequence[Rival], progress: Progress
) -> Discovery | None:
    """The most evident of the named rivals in its best form, if it explains everything and nothing convinces beside it."""
    known = [rival for rival in rivals if not is_unknown(rival)][:MOST]
    fitted = [one for rival in known for one in _fitted(workshop, given, base_search, rival, progress)]
    if not fitted:
        return None
    leader = max(fitted, key=lambda rival: rival.evidence)
    forms = in_all_forms(workshop, base_search, leader, [], leader.search)
    everything = [*fitted, *ranked_by_evidence(forms, base_search.deviance)]
    ranked = best_forms(sorted(everything, key=lambda rival: -rival.evidence))
    if not explains(ranked[0].search):
        return None
    chances, nothing = probabilities(ranked, len(ranked))
    first = Round(tuple(ranked), tuple(chances.tolist()), nothing, base_search.fitted())
    look = look_again(workshop, given, ranked[0].search.fitted(), ranked[:1], progress)
    found, _ = followed(workshop, given, base_search, [first], look, progress)
    return found if len(found.rounds) == 1 else None


def _fitted(workshop: Workshop, given: Misfit, base_search: Search, rival: Rival, progress: Progress) -> list[Rival]:
    """A rival re-identified with all runs; none where it cannot be placed."""
    alone = rebuild(workshop, base_search, [rival], rival.search)
    if alone is None:
        return []
    alone = again(workshop, given, evolve(rival, search=alone), progress)
    return [rival_of(rival.proposal, alone, base_search.deviance)]
