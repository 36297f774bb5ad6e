"""Which findings the final fit can spare, and what each is worth."""

from collections.abc import Sequence

from attrs import evolve

from crashkit.diagnose.claims import price_of
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.rebuild import alone_again, rebuild
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.look import LEAST_DROP, Look
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

THERE = 0.05
"""Share of what one finding explains that another at its place must explain: most of all, the error of a form looks like a
force where it is."""


def needed(
    workshop: Workshop, findings: Sequence[Look], base: Search, final: Search
) -> tuple[tuple[Look, ...], Search, Search]:
    """The findings without which the fit is plainly worse, and the fits without any and with these.

    An early finding may only have led the search past a local optimum.
    """
    kept, spared = list(findings), dict[tuple[str, str], Search | None]()
    for look in findings:
        base = alone_again(base, [look.leader.search.fitted()])
        others = _others(kept, look)
        without = rebuild(workshop, base, others, final)
        spared[look.leader.identity] = without
        if without is not None and without.deviance < final.deviance + _asked(look.leader, others, final.misfit):
            kept, final = [one for one in kept if one is not look], without
            spared.clear()  # those fits had it beside them
    for look in kept:
        if look.leader.identity not in spared:
            spared[look.leader.identity] = rebuild(workshop, base, _others(kept, look), final)
    told = [evolve(look, before=_before(workshop, look, spared[look.leader.identity] or base)) for look in kept]
    return tuple(told), base, final


def _others(kept: Sequence[Look], look: Look) -> list[Rival]:
    return [one.leader for one in kept if one is not look]


def _asked(rival: Rival, others: Sequence[Rival], misfit: Misfit) -> float:
    """Chi squared that a finding must explain beside the others."""
    place = rival.place
    there = [one.drop for one in others if one.place == place]
    return max([price(rival.proposal, misfit), *(THERE * drop for drop in there)])


def _before(workshop: Workshop, look: Look, without: Search) -> Misfit:
    """The fit with all other findings that were kept: when this one was made, others may have stood beside it."""
    model = without.fitted().model
    return workshop.equipped([model]).misfit(look.before, model)


def price(proposal: Proposal, misfit: Misfit) -> float:
    """Chi squared that a finding must explain to be worth its parameters, as the evidence counts them (Schwarz 1978)."""
    return max(LEAST_DROP, price_of(proposal, misfit.independent_samples))
