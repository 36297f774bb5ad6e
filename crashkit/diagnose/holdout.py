"""What runs that were held out say of what was found in the others."""

from collections.abc import Mapping, Sequence
from functools import partial

import xarray as xr

from crashkit.diagnose.fitting.evidence import UNEXPLAINED, is_at_noise, is_unknown
from crashkit.diagnose.fitting.leftover import normalised
from crashkit.diagnose.fitting.reidentify import refine
from crashkit.diagnose.fitting.search import Search
from crashkit.diagnose.fitting.sharpen import in_the_light_of, weighed_alike
from crashkit.diagnose.fitting.thresholds import wakened
from crashkit.diagnose.name.follow import LEAST_THIRD, TRACE, Discovery
from crashkit.diagnose.name.look import Look, is_exact
from crashkit.diagnose.workshop import Workshop
from crashkit.model import Model

PLAIN = 0.9
"""Probability of a finding from which no other claim need be asked for in its place."""


def fitted_together(
    workshop: Workshop,
    discovery: Discovery,
    model: Model,
    recordings: Mapping[str, xr.DataTree],
    holdout: Mapping[str, xr.DataTree],
) -> Search | None:
    """What explains the fitted runs, fitted to those held out as well. None where these are predicted, or those not explained.

    A prediction may be off because the fitted runs do not tell a number, or because a form is off that leaves something in
    them too: neither says that anything else is missing.
    """
    if not holdout:
        return None
    final = discovery.final
    workshop = workshop.equipped([final.model])
    unseen = weighed_alike(workshop.first_misfit(final.model, holdout), final)
    left = partial(normalised, told_only=bool(discovery.findings))
    if left(final) > UNEXPLAINED or left(unseen) < UNEXPLAINED:
        return None
    both = in_the_light_of(workshop, model, {**recordings, **holdout}, final)
    return wakened(workshop, refine(workshop.identifier, workshop.misfit(both, final.model)))


def asks_again(discovery: Discovery, together: Search) -> bool:
    """Whether all runs are asked: no values of what was found explain them, or nothing was found.

    The model's own numbers may make up for what it lacks in all runs, too, if at other values, and hide it but for one cause.
    Beside one number of an instrument there is no form that may be off, and more than chance leaves says that something is
    missing. Of other findings, only channels whose noise is told are witnesses, and they may leave of them what no further one
    would be told for.
    """
    if not discovery.findings:
        return True
    if all(is_exact(look.leader.proposal) for look in discovery.findings):
        return not is_at_noise(together)
    base, left = (normalised(misfit, told_only=True) for misfit in (discovery.base, together.fitted()))
    share = TRACE if len(discovery.findings) == 1 else LEAST_THIRD
    return left > UNEXPLAINED and left**2 - 1.0 > share * (base**2 - 1.0)


def says_more(discovery: Discovery, asked_again: Discovery, together: Search) -> bool:
    """Whether all runs say more than that the model explains them at other values: if not, those held out stay a test.

    An estimated force at the place of one of several known causes that explain the fitted runs says no more: it is that
    cause beyond what these reach, in a form that no list has.
    """
    named = {look.leader.place for look in discovery.findings if not is_unknown(look.leader)}
    estimated = {look.leader.place for look in asked_again.findings if is_unknown(look.leader)}
    if len(discovery.findings) > 1 and named & estimated:
        return False
    return bool(asked_again.findings) or not is_at_noise(together)


def leading_looks(discovery: Discovery) -> Sequence[Look]:
    """The looks that a held-out run which contradicts a discovery should be asked for first: its only one, or all where each
    finding was plain."""
    looks = discovery.findings or ((discovery.last,) if discovery.last else ())
    return looks if len(looks) == 1 or all(look.probabilities[0] > PLAIN for look in looks) else ()
