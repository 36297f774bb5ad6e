"""Every finding in its best form: one that was found first had to make do for those that came after it."""

from collections.abc import Sequence

import numpy as np
from attrs import evolve

from crashkit.diagnose.contest import Entrant, Progress, heats, identity, promising, scores, scouted
from crashkit.diagnose.look import Round, is_unknown
from crashkit.diagnose.name import Rival, explains, propose_all
from crashkit.diagnose.rebuild import rebuild
from crashkit.diagnose.search import Search
from crashkit.diagnose.workshop import Workshop
from crashkit.protocols import Proposal

STARTS = 3
"""Of each form."""
HEATS = ((12, 8), (4, 40))


def in_best_forms(
    workshop: Workshop, base_search: Search, rounds: Sequence[Round], search: Search, progress: Progress
) -> tuple[list[Round], Search]:
    """The findings, each in the form that is most evident beside the others, and the fit with them.

    Arguments:
        base_search: the fit of the model without them.
        search: the fit with them; where it leaves nothing, no form is questioned.
    """
    looks = list(rounds)
    for index, look in enumerate(rounds):
        if explains(search) or is_unknown(look.rivals[0]):
            continue
        others = [other.rivals[0] for other in looks if other is not look]
        entrants = _other_forms(workshop, base_search, look.rivals[0], others, search, progress)
        better = max((_instead(look.rivals[0], search, *entrant) for entrant in entrants), key=_evidence, default=None)
        if better is not None and better.evidence > look.rivals[0].evidence:
            looks[index], search = evolve(look, rivals=(better, *look.rivals[1:])), better.search
    return looks, search


def _other_forms(
    workshop: Workshop, base_search: Search, rival: Rival, others: Sequence[Rival], search: Search, progress: Progress
) -> list[Entrant]:
    """Fits of a claim's other forms, from where its present one has driven all other numbers."""
    without = rebuild(workshop, base_search, others, search)
    if without is None:
        return []
    origin = without.misfit.with_values_of(search.fitted())
    claims = [p for p in propose_all(workshop.hypotheses, origin) if identity(p) == rival.identity]
    forms = [p for p in claims if p.form != rival.proposal.form]
    equipped = workshop.equipped([p.model for p in forms])
    chosen = promising(scores(equipped, origin, forms, np.inf, progress), STARTS, 0.0)
    return heats(scouted(equipped, origin, chosen, (1.0,), HEATS[0][0], np.inf), HEATS, progress)


def _instead(rival: Rival, search: Search, proposal: Proposal, found: Search) -> Rival:
    """A form in place of another that left more or needed more numbers."""
    gained = search.deviance - found.deviance
    price = (len(proposal.parameters) - len(rival.proposal.parameters)) * np.log(search.misfit.independent_samples)
    return Rival(proposal, found, rival.drop + gained, rival.evidence + 0.5 * (gained - price))


def _evidence(rival: Rival) -> float:
    return rival.evidence
