"""A further run contradicts what was found: what came second may explain it."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.contest import Progress
from crashkit.diagnose.evidence import Rival, best_forms, explains, probabilities, ranked_by_evidence, rival_of
from crashkit.diagnose.forms import in_all_forms
from crashkit.diagnose.look import Round, is_unknown, look_again
from crashkit.diagnose.name import again
from crashkit.diagnose.rebuild import rebuild
from crashkit.diagnose.rounds import Discovery, followed
from crashkit.diagnose.search import Search
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit

MOST = 3
"""How many rivals are tried, the contradicted one among them: its other forms may explain more."""


def second_best(
    workshop: Workshop, given: Misfit, base_search: Search, rivals: Sequence[Rival], progress: Progress
) -> Discovery | None:
    """The most evident of the named rivals in its best form, if it explains everything and nothing convinces beside it.

    Arguments:
        base_search: the best fit of the model without them, to all runs.
        rivals: as they were ranked without the run that contradicts the first.
    """
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
