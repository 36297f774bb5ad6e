"""Which findings the final fit can spare, and what each is worth."""

from collections.abc import Sequence

import numpy as np
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.rebuild import alone_again, rebuild
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.look import LEAST_DROP, Round
from crashkit.diagnose.result import place_of
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

THERE = 0.05
"""Share of what one finding explains that another at its place must explain: most of all, the error of a form looks like a
force where it is."""


def needed(
    workshop: Workshop, rounds: Sequence[Round], base: Search, final: Search
) -> tuple[tuple[Round, ...], Search, Search]:
    """The findings without which the fit is plainly worse, and the fits without any and with these.

    An early finding may only have led the search past a local optimum.
    """
    kept = list(rounds)
    for look in rounds:
        others = [one for one in kept if one is not look]
        base = alone_again(base, [look.leader.search.fitted()])
        without = rebuild(workshop, base, [one.leader for one in others], final)
        if without is not None and without.deviance < final.deviance + _asked(look.leader, others, final.misfit):
            kept, final = others, without
    return tuple(evolve(look, before=_without(workshop, look, kept, base, final)) for look in kept), base, final


def _asked(rival: Rival, others: Sequence[Round], misfit: Misfit) -> float:
    """Chi squared that a finding must explain beside the others."""
    place = place_of(rival.proposal.location)
    there = [one.leader.drop for one in others if place_of(one.leader.proposal.location) == place]
    return max([price(rival.proposal, misfit), *(THERE * drop for drop in there)])


def _without(workshop: Workshop, look: Round, kept: Sequence[Round], base: Search, final: Search) -> Misfit:
    """The fit with all other findings that were kept: when this one was made, others may have stood beside it."""
    others = [one.leader for one in kept if one is not look]
    model = (rebuild(workshop, base, others, final) or base).fitted().model
    return workshop.equipped([model]).misfit(look.before, model)


def price(proposal: Proposal, misfit: Misfit) -> float:
    """Chi squared that a finding must explain to be worth its parameters, as the evidence counts them (Schwarz 1978)."""
    return max(LEAST_DROP, len(proposal.parameters) * float(np.log(misfit.independent_samples)))


def run_drops(before: Misfit, after: Misfit) -> dict[str, float]:
    """By how much chi squared drops in each run, weighed as before."""
    alike = [misfit.channel_sums(misfit.residual(misfit.start())) * _levels(misfit) ** 2 for misfit in (before, after)]
    drops = (alike[0] - alike[1]) / _levels(before) ** 2
    runs = [channel.run for channel in before.channels]
    return {run: float(np.sum(drops[[r == run for r in runs]])) for run in before.recordings}


def _levels(misfit: Misfit) -> np.ndarray:
    return np.array([channel.noise.std for channel in misfit.channels])
