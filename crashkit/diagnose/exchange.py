"""A finding that stands in for another is exchanged for what stands out beside it."""

from collections.abc import Iterator, Sequence

from attrs import evolve

from crashkit.diagnose.look import Round, is_unknown
from crashkit.diagnose.name import explains
from crashkit.diagnose.rebuild import rebuild
from crashkit.diagnose.reidentify import best_of_many
from crashkit.diagnose.search import STEPS, Search, begin
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit

MOST = 2
"""How many named causes of the last look are tried in the place of each finding."""
GAIN = 20.0
"""Chi squared that the exchange must gain."""


def exchanged(
    workshop: Workshop, given: Misfit, base_search: Search, rounds: Sequence[Round], search: Search, last: Round
) -> tuple[list[Round], Search] | None:
    """The findings with one of them exchanged, where as many explain more; None if none do.

    What stands out beside a stand-in explains too little to be told as one more, but more than that stand-in does.

    Arguments:
        base_search: the fit of the model without them.
        search: the fit with them.
        last: the look at what they leave.
    """
    if explains(search):
        return None
    best = min(_exchanges(workshop, given, base_search, rounds, last), key=lambda one: one[1].deviance, default=None)
    return best if best and best[1].deviance < search.deviance - GAIN else None


def _exchanges(
    workshop: Workshop, given: Misfit, base_search: Search, rounds: Sequence[Round], last: Round
) -> Iterator[tuple[list[Round], Search]]:
    named = [rival for rival in last.rivals if not is_unknown(rival)][:MOST]
    for rival in named:
        for place in range(len(rounds)):
            rest = [*rounds[:place], *rounds[place + 1 :]]
            placed = rebuild(workshop, base_search, [*(look.rivals[0] for look in rest), rival], rival.search)
            if placed is not None:
                found = _anywhere(workshop, given, placed)
                others = [other for other in last.rivals if other is not rival]
                yield [*rest, evolve(last, rivals=(evolve(rival, search=found), *others))], found


def _anywhere(workshop: Workshop, given: Misfit, placed: Search) -> Search:
    """The better of the fit and one from the values that the user gave, and others about them."""
    misfit = placed.fitted().with_values_of(given)
    found = misfit.with_values(misfit.values(best_of_many(workshop.identifier, misfit)))
    return min(placed, begin(workshop.identifier, found).advance(STEPS), key=lambda search: search.deviance)
