"""A finding that stands in for another is exchanged for what stands out beside it."""

from collections.abc import Iterator, Sequence

from crashkit.diagnose.fitting.evidence import explains, is_unknown, ranked_by_evidence, rival_of
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.forms import in_all_forms
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look, compared

MOST = 2
"""How many named causes of the last look, of those more evident than nothing, are tried in the place of each finding."""
GAIN = 10.0
"""Log evidence that the exchange must gain."""


def exchanged(inquiry: Inquiry, findings: Sequence[Look], search: Search, last: Look) -> tuple[list[Look], Search] | None:
    """The findings with one of them exchanged, where that is more evident; None if none is.

    What stands out beside a stand-in explains too little to be told as one more, but more than that stand-in does.

    Arguments:
        search: the fit with them.
        last: the look at what they leave.
    """
    if explains(search):
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
