"""Which findings the final fit can spare, and what each is worth."""

from collections.abc import Mapping, Sequence

import numpy as np
from attrs import evolve

from crashkit.diagnose.claims import price_of
from crashkit.diagnose.fitting.back_to_given import begun_at_given
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.rebuild import alone_again, rebuild
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.name.look import COMPLETING, FORM_ERRORS, LEAST_DROP, Look, least_drop, least_of
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.protocols import Proposal

THERE = 0.05
"""Share of what one finding explains that another at its place must explain: most of all, the error of a form looks like a
force where it is."""

Without = Mapping[tuple[str, str], Search | None]
"""Of each finding, the fit with all others; None where one of them has no place alone."""


def needed(
    workshop: Workshop, findings: Sequence[Look], base: Search, final: Search, given: Misfit
) -> tuple[tuple[Look, ...], Search, Search]:
    """The findings without which the fit is plainly worse, and the fits without any and with these.

    An early finding may only have led the search past a local optimum.

    Arguments:
        given: the model as the user gave it.
    """
    for look in findings:
        base = alone_again(base, [look.leader.search.fitted()])
    kept, without = list(findings), _without_each(workshop, findings, base, final, given)
    while spare := _spare(kept, without, base, final):
        kept, final = [look for look in kept if look is not spare], without[spare.leader.identity] or base
        without = _without_each(workshop, kept, base, final, given)
    told = [evolve(look, before=_before(workshop, look, without[look.leader.identity] or base)) for look in kept]
    return tuple(told), base, final


def _without_each(workshop: Workshop, kept: Sequence[Look], base: Search, final: Search, given: Misfit) -> Without:
    rivals = [look.leader for look in kept]
    fits: dict[tuple[str, str], Search | None] = {}
    for one in rivals:
        others = [rival for rival in rivals if rival is not one]
        fit = rebuild(workshop, base, others, final)
        fits[one.identity] = _as_given(fit, one, given) if fit and others else fit
    return fits


def _as_given(without: Search, rival: Rival, given: Misfit) -> Search:
    """Or from the given numbers of its joint: beside others a finding may make up for what these have driven them to."""
    joint = rival.proposal.location.get("joint")
    return begun_at_given(without, given, str(joint)) if joint else without


def _spare(kept: Sequence[Look], without: Without, base: Search, final: Search) -> Look | None:
    """The finding that explains least beside the others, if that is less than is asked of it; else the next such one."""
    fits = ((look, without[look.leader.identity]) for look in kept)
    explained = [(look, np.inf if fit is None else fit.deviance - final.deviance) for look, fit in fits]
    drops = [(look.leader, drop) for look, drop in explained]
    all_together = base.deviance - final.deviance
    ranked = sorted(explained, key=lambda one: one[1])
    return next((look for look, drop in ranked if drop < _asked(look.leader, drops, all_together, final.misfit)), None)


def _asked(rival: Rival, explained: Sequence[tuple[Rival, float]], together: float, misfit: Misfit) -> float:
    """Chi squared that a finding must explain beside all, which explain so much in the final fit.

    What one explained when it was found says less: thinned recordings hardly show what rings. One of three may have been found
    before those that made it spare, and is asked at least what a third one is that leaves nothing. Of those at one place each
    may do for most of what they explain together, and another for what its form is off by.
    """
    others = [one for one, _ in explained if one is not rival]
    third = COMPLETING * least_of(rival.proposal, least_drop(others)) if len(others) > 1 else 0.0
    there = [drop for one, drop in explained if one.place == rival.place and one is not rival and np.isfinite(drop)]
    form = FORM_ERRORS[0] * together if others and all(one.place == rival.place for one in others) else 0.0
    return max([price(rival.proposal, misfit), third, form, *(THERE * drop for drop in there)])


def _before(workshop: Workshop, look: Look, without: Search) -> Misfit:
    """The fit with all other findings that were kept: when this one was made, others may have stood beside it."""
    model = without.fitted().model
    return workshop.equipped([model]).misfit(look.before, model)


def price(proposal: Proposal, misfit: Misfit) -> float:
    """Chi squared that a finding must explain to be worth its parameters, as the evidence counts them (Schwarz 1978)."""
    return max(LEAST_DROP, price_of(proposal, misfit.independent_samples))
