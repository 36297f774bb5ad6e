"""The diagnosis: re-identify, compare, locate, name, model, show."""

import math
from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.campaign import one_thread
from crashkit.diagnose.fitting.contest import Progress
from crashkit.diagnose.fitting.evidence import STRAINED, UNEXPLAINED, is_at_noise
from crashkit.diagnose.fitting.in_time import TimeLimit, in_time
from crashkit.diagnose.fitting.reidentify import refine, reidentify
from crashkit.diagnose.fitting.search import STEPS, Search, begin
from crashkit.diagnose.fitting.sharpen import ROUGHLY, OutrunError, in_the_light_of, sharpened, weighed_alike
from crashkit.diagnose.fitting.thinning import thinned_by
from crashkit.diagnose.fitting.thresholds import awake, wakened
from crashkit.diagnose.name.discover import discover
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.needed import needed, price
from crashkit.diagnose.name.rivals import CONCEALED
from crashkit.diagnose.name.twins import beside_twins
from crashkit.diagnose.result import Diagnosis
from crashkit.diagnose.show.answer import answer
from crashkit.diagnose.show.fits import fit_of, predict
from crashkit.diagnose.show.words import cut_short, nothing_predicted
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit, fine_step
from crashkit.model import Model

PLAIN = 0.9
"""Probability of a finding from which no other claim need be asked for in its place."""


@one_thread
def diagnose(
    model: Model,
    recordings: Mapping[str, xr.DataTree],
    holdout: Mapping[str, xr.DataTree],
    workshop: Workshop,
    progress: Progress = lambda doing, share: None,
    seconds: float = math.inf,
) -> Diagnosis:
    """Whether simulation and recordings differ, where, what physics was left out, and what modelling it gains.

    Arguments:
        model: as the user believes it.
        recordings: the runs to fit, by name.
        holdout: runs that are only predicted; where no values of what was found explain them beside the others, they are
            evidence of more, and are fitted like the others, which a note then says.
        workshop: the plugins to work with.
        progress: told what is being done and how far it is.
        seconds: after which no further question is asked; what was found by then is told, and that there was more to ask.
    """
    limit = TimeLimit(seconds, progress)
    rehearsed = workshop.rehearsed(model, [*recordings.values(), *holdout.values()])
    equipped, discovery = _discovered_in(rehearsed, model, recordings, limit)
    together = None if limit.is_over else _fitted_together(equipped, discovery, model, recordings, holdout)
    if together is not None and _is_contradicted(discovery, together):
        looks = _leading(discovery)
        again, asked_again = _discovered_in(rehearsed, model, {**recordings, **holdout}, limit, looks)
        if not limit.is_over:
            return nothing_predicted(answer(again, asked_again, model, {}), tuple(holdout))
    told = answer(equipped, discovery, model, holdout, together)
    return cut_short(told, seconds) if limit.is_over else told


def _discovered_in(
    equipped: Workshop,
    model: Model,
    recordings: Mapping[str, xr.DataTree],
    progress: TimeLimit,
    looks: Sequence[Look] = (),
) -> tuple[Workshop, Discovery]:
    """What these recordings say that the model leaves out, and the workshop with the steps that they need.

    Arguments:
        looks: that led to an answer which these recordings contradict; what they say is asked first.
    """
    progress.show("re-identifying the model", 0.0)
    given = equipped.first_misfit(model, thinned_by(equipped, recordings, model)).with_prior(ROUGHLY)
    # The first simulation compiles the engine, before copies of this process would each do so.
    equipped = evolve(equipped, step=fine_step(given))
    given = given.with_step(equipped.step)
    base = reidentify(equipped, given)
    # Numbers far from what the user gave make up for physics: what they ask of the rate, the structure does not.
    if base.misfit.departure(base.point) <= STRAINED:
        base = sharpened(equipped, model, recordings, base)
    discovery = _discovered_at_pace(equipped, model, recordings, awake(equipped, given, base), base, looks, progress)
    progress.show("refining", 0.0)
    discovery = beside_twins(equipped, discovery)
    return equipped, _refined(equipped, discovery, model, recordings)


def _discovered_at_pace(
    workshop: Workshop,
    model: Model,
    recordings: Mapping[str, xr.DataTree],
    given: Misfit,
    base: Search,
    looks: Sequence[Look],
    progress: TimeLimit,
) -> Discovery:
    """What is found in time; where that outruns the recordings as they were thinned, by finer ones."""
    nothing = Discovery(base.fitted(), base.fitted(), base)
    at_pace = Inquiry(evolve(workshop, recorded=recordings), base.misfit.with_values_of(given), base, progress)
    try:
        return in_time(nothing, discover, at_pace, looks)
    except OutrunError as outrun:
        found = outrun.found
    thin = in_the_light_of(workshop, model, recordings, found.search.fitted())
    base = begin(workshop.identifier, thin.with_values(base.values)).advance(STEPS)
    alone = Look((found,), (1.0,), 0.0, base.fitted())
    so_far = Discovery(base.fitted(), found.search.fitted(), found.search, (alone,))
    finer = Inquiry(workshop, base.misfit.with_values_of(given), base, progress)
    return in_time(so_far, discover, finer, (alone,))


def _fitted_together(
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
    normalised = partial(_normalised, told_only=bool(discovery.findings))
    if normalised(final) > UNEXPLAINED or normalised(unseen) < UNEXPLAINED:
        return None
    both = in_the_light_of(workshop, model, {**recordings, **holdout}, final)
    return wakened(workshop, refine(workshop.identifier, workshop.misfit(both, final.model)))


def _is_contradicted(discovery: Discovery, together: Search) -> bool:
    """Whether no values of what was found explain all runs. Where nothing was found there is no form that may be off, and more
    than chance leaves says that something is missing. Of a finding, only channels whose noise is told are witnesses."""
    if not discovery.findings:
        return not is_at_noise(together)
    return _normalised(together.fitted(), told_only=True) > UNEXPLAINED


def _normalised(misfit: Misfit, told_only: bool) -> float:
    """Residual over noise at the misfit's own values, of all channels or of those whose noise is told; 0 if there are none."""
    channels = fit_of(misfit, predict(misfit)).channels
    counts = channels["independent_samples"].values * [one.noise.trusted or not told_only for one in misfit.channels]
    return float(np.sqrt(np.sum(channels["normalised_rmse"].values ** 2 * counts) / max(counts.sum(), 1e-9)))


def _refined(workshop: Workshop, discovery: Discovery, model: Model, recordings: Mapping[str, xr.DataTree]) -> Discovery:
    """The base and the final model fitted to more samples, weighed alike, and seen on every sample.

    Open noise levels are now what the final model leaves. What that fit can do without is not told. Numbers that the
    recordings do not see stay about where the user gave them.
    """
    workshop = workshop.equipped([discovery.base.model, discovery.final.model])
    found = discovery.final.reweighted(discovery.final.start())
    thin = in_the_light_of(workshop, model, recordings, found)
    without, final = (workshop.misfit(thin, one.model) for one in (discovery.base, discovery.final))
    found_with = refine(workshop.identifier, final)
    found_without = _unexplained(workshop, without) if discovery.findings else found_with
    findings, *searches = needed(workshop, discovery.findings, found_without, found_with)
    searches = [sharpened(workshop, model, recordings, search) for search in searches]
    full = weighed_alike(workshop.first_misfit(model, recordings), found)
    base, final = (workshop.misfit(full, search.fitted().model) for search in searches)
    if findings and _is_worthless(findings, base, final):
        findings, final, searches = (), base, [searches[0]] * 2
    last = discovery.findings[0] if discovery.findings and not findings else discovery.last
    return evolve(discovery, base=base, final=final, search=searches[1].unbelieving(), findings=findings, last=last)


def _unexplained(workshop: Workshop, misfit: Misfit) -> Search:
    """The fit of the model as it is. Where it leaves much, other starts are not worth their time: they would have to leave
    as little as a finding does."""
    search = begin(workshop.identifier, misfit).advance(STEPS)
    return search if search.normalised > CONCEALED else refine(workshop.identifier, misfit)


def _leading(discovery: Discovery) -> Sequence[Look]:
    """The looks that a held-out run which contradicts a discovery should be asked for first: its only one, or all where each
    finding was plain."""
    looks = discovery.findings or ((discovery.last,) if discovery.last else ())
    return looks if len(looks) == 1 or all(look.probabilities[0] > PLAIN for look in looks) else ()


def _is_worthless(findings: Sequence[Look], base: Misfit, final: Misfit) -> bool:
    """Whether all samples together show less than the findings cost: then these explained what thinning had left."""
    before, after = (misfit.deviance(misfit.residual(misfit.start())) for misfit in (base, final))
    return before - after < sum(price(look.leader.proposal, final) for look in findings)
