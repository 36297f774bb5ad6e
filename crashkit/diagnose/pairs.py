"""Two named causes instead of one estimated table, which takes up much of two effects at once, but not all."""

from collections.abc import Iterator

from attrs import evolve

from crashkit.diagnose.contest import Progress
from crashkit.diagnose.look import Round, is_unknown, look_again, settled
from crashkit.diagnose.name import FLOOR, Rival, probabilities
from crashkit.diagnose.rebuild import rebuild
from crashkit.diagnose.search import Search
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit


def named_before_unknown(
    workshop: Workshop, given: Misfit, base_search: Search, look: Round, progress: Progress
) -> tuple[list[Round], Round]:
    """Nothing and the round; or, where an unknown force has won it, two named causes that fit better than its table.

    One table takes up much of two effects at once, but not all, where each of them alone leaves the other.
    """
    table = look.winner
    if table is None or not is_unknown(table) or table.search.normalised < FLOOR:
        return [], look
    for first, second in _pairs(workshop, given, base_search, look, table, progress):
        other = second.winner
        if other is not None and not is_unknown(other) and other.search.deviance < table.search.deviance:
            return [first], second
    return [], look


def _pairs(
    workshop: Workshop, given: Misfit, base_search: Search, look: Round, table: Rival, progress: Progress
) -> Iterator[tuple[Round, Round]]:
    """The best named cause, and what is left beside it; then the cause that stands out beside the table, likewise."""
    named = [rival for rival in look.rivals if not is_unknown(rival)]
    chances, nothing = probabilities(named, len(named))
    first = evolve(look, rivals=tuple(named), probabilities=tuple(chances.tolist()), nothing=nothing)
    if first.winner is not None:
        first = settled(workshop, given, first, first.winner, progress)
        yield first, look_again(workshop, given, first.rivals[0].search.fitted(), [first.rivals[0]], progress)
    beside = look_again(workshop, given, table.search.fitted(), [table], progress)
    if beside.winner is None or is_unknown(beside.winner):
        return
    alone = rebuild(workshop, base_search, [beside.winner], beside.winner.search)
    if alone is not None:
        found = evolve(beside.winner, search=alone)
        first = evolve(beside, rivals=(found, *beside.rivals[1:]))
        yield first, look_again(workshop, given, alone.fitted(), [found], progress)
