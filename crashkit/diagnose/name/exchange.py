"""A finding that stands in for another is exchanged: for what stands out beside it, or for what explained nearly as much."""

from collections.abc import Iterator, Sequence

from crashkit.campaign import spread
from crashkit.diagnose.fitting.evidence import FLOOR, Rival, explains, is_sound, is_unknown, ranked_by_evidence, rival_of
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.forms import in_all_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared

MOST = 2
"""How many named causes of the last look, of those more evident than nothing, are tried in the place of each finding."""
GAIN = 10.0
"""Log evidence that the exchange must gain."""
NEARLY = 0.8
"""Of what a finding explained alone: a known cause that explained as much may explain more beside the next one."""


def exchanged(inquiry: Inquiry, findings: Sequence[Look], search: Search, last: Look) -> tuple[list[Look], Search] | None:
    """The findings with one of them exchanged, where that is more evident; None if none is.

    What stands out beside a stand-in explains too little to be told as one more, but more than that stand-in does.

    Arguments:
        search: the fit with them.
        last: the look at what they leave.
    """
    if explains(search) or (search.normalised < FLOOR and is_sound(search)):
        return None
    return min(_exchanges(inquiry, findings, search, last), key=lambda one: one[1].deviance, default=None)


def _exchanges(inquiry: Inquiry, findings: Sequence[Look], search: Search, last: Look) -> Iterator[tuple[list[Look], Search]]:
    named = [rival for rival in last.rivals if not is_unknown(rival) and rival.evidence > 0.0][:MOST]
    for rival in named:
        for place, look in enumerate(findings):
            rest = [*findings[:place], *findings[place + 1 :]]
            without = search.deviance + look.leader.drop
            forms = in_all_forms(inquiry, rival, [one.leader for one in rest], search)
            old, new = rival_of(look.leader.proposal, search, without), ranked_by_evidence(forms, without)[:1]
            if new and new[0].evidence > old.evidence + GAIN:
                yield [*rest, compared(look, [*new, old])], new[0].search


def in_its_stead(inquiry: Inquiry, findings: Sequence[Look], search: Search) -> tuple[list[Look], Search]:
    """The findings, one of those before the last exchanged for what explained nearly as much alone, where that is more evident
    beside the last.

    Of two causes that explain about as much alone, the wrong one may well lead.

    Arguments:
        search: the fit with them.
    """
    if is_unknown(findings[-1].leader):
        return list(findings), search
    for place, look in enumerate(findings[:-1]):
        rest = [one.leader for one in findings if one is not look]
        without = search.deviance + look.leader.drop
        old = rival_of(look.leader.proposal, search, without)
        best = max([old, *_fitted_beside(inquiry, _runners_up(look), rest, search, without)], key=lambda one: one.evidence)
        if best.evidence > old.evidence + GAIN:
            return [*findings[:place], compared(look, [best, old]), *findings[place + 1 :]], best.search
    return list(findings), search


def _fitted_beside(
    inquiry: Inquiry, rivals: Sequence[Rival], rest: Sequence[Rival], search: Search, without: float
) -> list[Rival]:
    """Each of these claims beside others, from where it has driven the model's numbers alone, and from where they are now."""
    starts = [(rival, last) for rival in rivals for last in (rival.search, search)]
    ends = spread(lambda start: inquiry.fit_with([start[0], *rest], start[1]), starts)
    return [rival_of(rival.proposal, end, without) for (rival, _), end in zip(starts, ends, strict=True) if end is not None]


def _runners_up(look: Look) -> list[Rival]:
    """What explained nearly as much as the leader of a look."""
    first, *others = look.rivals
    return [rival for rival in others if not is_unknown(rival) and rival.drop > NEARLY * first.drop][:MOST]
