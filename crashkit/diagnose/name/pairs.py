"""Two causes where no single one explains enough: a couple at once, or named ones instead of an estimated table."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.claims import identity
from crashkit.diagnose.fitting.evidence import (
    FLOOR,
    Rival,
    best_forms,
    by_evidence,
    explains,
    is_unknown,
    rival_of,
)
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.forms import in_best_forms
from crashkit.diagnose.name.imitate import with_imitations
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared, least_drop, look_again
from crashkit.diagnose.name.settle import settled


def named_before_unknown(inquiry: Inquiry, look: Look) -> tuple[list[Look], Look]:
    """Nothing and the look; or, where an unknown force has won it, what named causes fit better than its table.

    One of them may be enough, and only be caught in a poor form or a local optimum. Two are asked for where the table leaves
    something: it takes up much of two effects at once, but not all, where each of them alone leaves the other.
    """
    table = look.winner
    if table is None or not is_unknown(table):
        return [], look
    named = _named(inquiry, look, table)
    if _is_told_by(named.winner, table):
        return [], named
    if table.search.normalised < FLOOR:
        return [], look
    if named.winner is not None:
        second = look_again(inquiry, named.winner.search.fitted(), [named.winner])
        if _beats(second.winner, table):
            return [named], second
    return _standing_out(inquiry, look, table) or ([], look)


def named_instead(inquiry: Inquiry, look: Look, table: Rival) -> Look | None:
    """The look without estimates, led by what imitates its table, in its best form; None if that leaves more."""
    named = _named(inquiry, look, table)
    return named if _is_told_by(named.winner, table) else None


def named_beside(inquiry: Inquiry, look: Look, findings: Sequence[Look]) -> Look:
    """The look; or, where an unknown force has won it beside findings, with a known cause at its place that is all there is.

    Beside what was found first a known cause may be caught where that had bent the numbers of its place, and the table not.
    Where a finding is already, an estimate only says how far the form of that is off.
    """
    table, places = look.winner, [one.leader.place for one in findings]
    if not places or table is None or not is_unknown(table) or table.place in places:
        return look
    named = with_imitations(inquiry, look, table)
    return named if _is_told_by(named.winner, table) else look


def both(inquiry: Inquiry, look: Look) -> tuple[Look, Look] | None:
    """The leading couple of a look as two findings, each in the light of the other; None where one cannot be placed alone, or
    the second does not convince beside the first."""
    couple = look.couples[0]
    claims = [Rival(proposal, couple.search, 0.0, 0.0) for proposal in (couple.first, couple.second)]
    alone = [inquiry.fit_with([claim], couple.search) for claim in claims]
    if alone[0] is None or alone[1] is None:
        return None
    # A claim alone may be caught far away, where the other would seem to explain more than there was to explain.
    without = [min(one, inquiry.base, key=lambda search: search.deviance) for one in (alone[0], alone[1])]
    first = _second_beside(look, without[1], identity(couple.second), [])
    second = _second_beside(look, without[0], identity(couple.first), [first.leader])
    return (first, second) if second.winner else None


def _second_beside(look: Look, without: Search, kept: tuple[str, str], found: Sequence[Rival]) -> Look:
    """The look of all claims that were coupled with one, that one alone being found before."""
    rivals = []
    for couple in look.couples:
        others = [proposal for proposal in (couple.first, couple.second) if identity(proposal) != kept]
        if len(others) == 1:
            rivals.append(rival_of(others[0], couple.search, without.deviance))
    ranked = best_forms(by_evidence(rivals))
    return compared(evolve(look, before=without.fitted(), least=least_drop(found), couples=()), ranked)


def _is_told_by(rival: Rival | None, table: Rival) -> bool:
    """Whether a known cause is told instead of a table."""
    return _beats(rival, table) or _is_all(rival, table)


def _beats(rival: Rival | None, table: Rival) -> bool:
    return rival is not None and not is_unknown(rival) and rival.search.deviance < table.search.deviance


def _is_all(rival: Rival | None, table: Rival) -> bool:
    """Whether nothing is left beside a named cause, which has fewer numbers than a table that leaves hardly less."""
    return rival is not None and not is_unknown(rival) and explains(rival.search) and rival.evidence > table.evidence


def _named(inquiry: Inquiry, look: Look, table: Rival) -> Look:
    """The look without estimates, with what imitates its table, its winner in the best form."""
    known = [rival for rival in with_imitations(inquiry, look, table).rivals if not is_unknown(rival)]
    first = compared(look, known)
    if first.winner is None:
        return first
    first = settled(inquiry, first, first.winner, [])
    (best,), _ = in_best_forms(inquiry, [first], first.leader.search)
    return best


def _standing_out(inquiry: Inquiry, look: Look, table: Rival) -> tuple[list[Look], Look] | None:
    """The cause that stands out beside the table, and what is left beside it; or nothing and the look that it leads, where it
    is all there is: an error of a sensor may be found only where a table has taken up what hid it."""
    beside = look_again(inquiry, table.search.fitted(), [table], quick=True)
    if beside.winner is None or is_unknown(beside.winner):
        return None
    alone = inquiry.fit_with([beside.winner], beside.winner.search)
    if alone is None:
        return None
    single = compared(look, [rival_of(beside.winner.proposal, alone, table.without), *look.rivals])
    if _is_all(single.winner, table):
        return [], single
    found = evolve(beside.winner, search=alone)
    second = look_again(inquiry, alone.fitted(), [found])
    return ([beside.led_by(found)], second) if _beats(second.winner, table) else None
