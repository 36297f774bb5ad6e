"""The given model with some findings and without others, fitted again."""

from collections.abc import Sequence

from crashkit.diagnose.contest import is_same, propose_all
from crashkit.diagnose.evidence import Rival
from crashkit.diagnose.search import STEPS, Search, begin
from crashkit.diagnose.workshop import Workshop


def without_winner(search: Search, winner: Rival) -> Search:
    """The model without the winner from where that has moved its numbers: it may have won by leaving a local optimum."""
    return begin(search.identifier, search.misfit.with_values_of(winner.search.fitted())).advance(STEPS)


def rebuild(workshop: Workshop, base_search: Search, rivals: Sequence[Rival], last: Search) -> Search | None:
    """The given model with these findings, fitted, from the values that they were last given; None if one cannot be placed."""
    search = base_search
    for rival in rivals:
        current = search.fitted()
        proposal = next((p for p in propose_all(workshop, current) if is_same(p, rival.proposal)), None)
        if proposal is None:
            return None
        found = {**rival.search.misfit.values(rival.search.point), **last.misfit.values(last.point)}
        misfit = workshop.equipped([proposal.model]).misfit(current, proposal.model)
        start = {name: found[name] for name in misfit.names if name in found}
        search = begin(workshop.identifier, misfit.with_values(start)).advance(STEPS)
    return search
