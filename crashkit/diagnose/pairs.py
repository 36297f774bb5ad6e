"""Named causes instead of an estimated table: one in its best form, or two where the table takes up much of both at once."""

from collections.abc import Iterator

from attrs import evolve

from crashkit.diagnose.contest import Progress
from crashkit.diagnose.evidence import FLOOR, Rival, best_forms, ranked_by_evidence
from crashkit.diagnose.forms import in_best_forms
from crashkit.diagnose.imitate import imitating
from crashkit.diagnose.look import Round, between, is_unknown, look_again
from crashkit.diagnose.rebuild import rebuild
from crashkit.diagnose.search import Search
from crashkit.diagnose.settle import settled
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit


def named_before_unknown(
    workshop: Workshop, given: Misfit, base_search: Search, look: Round, progress: Progress
) -> tuple[list[Round], Round]:
    """Nothing and the round; or, where an unknown force has won it, what named causes fit better than its table.

    One of them may be enough, and only be caught in a poor form or a local optimum. Two are asked for where the table leaves
    something: it takes up much of two effects at once, but not all, where each of them alone leaves the other.
    """
    table = look.winner
    if table is None or not is_unknown(table):
        return [], look
    named = _named(workshop, given, base_search, look, table, progress)
    if _beats(named.winner, table):
        return [], named
    if table.search.normalised < FLOOR:
        return [], look
    for first, second in _pairs(workshop, given, base_search, named, table, progress):
        if _beats(second.winner, table):
            return [first], second
    return [], look


def _beats(rival: Rival | None, table: Rival) -> bool:
    return rival is not None and not is_unknown(rival) and rival.search.deviance < table.search.deviance


def _named(workshop: Workshop, given: Misfit, base_search: Search, look: Round, table: Rival, progress: Progress) -> Round:
    """The round without estimates, with what imitates its table, its winner in the best form."""
    imitations = imitating(workshop, base_search, table, progress)
    rivals = [*look.rivals, *ranked_by_evidence(imitations, table.drop + table.search.deviance)]
    known = sorted((rival for rival in rivals if not is_unknown(rival)), key=lambda rival: -rival.evidence)
    first = between(look, best_forms(known))
    if first.winner is None:
        return first
    first = settled(workshop, given, first, first.winner, [], progress)
    (best,), _ = in_best_forms(workshop, base_search, [first], first.rivals[0].search, progress)
    return best


def _pairs(
    workshop: Workshop, given: Misfit, base_search: Search, named: Round, table: Rival, progress: Progress
) -> Iterator[tuple[Round, Round]]:
    """The best named cause, and what is left beside it; then the cause that stands out beside the table, likewise."""
    if named.winner is not None:
        yield named, look_again(workshop, given, named.winner.search.fitted(), [named.winner], progress)
    beside = look_again(workshop, given, table.search.fitted(), [table], progress)
    if beside.winner is None or is_unknown(beside.winner):
        return
    alone = rebuild(workshop, base_search, [beside.winner], beside.winner.search)
    if alone is not None:
        found = evolve(beside.winner, search=alone)
        first = evolve(beside, rivals=(found, *beside.rivals[1:]))
        yield first, look_again(workshop, given, alone.fitted(), [found], progress)
