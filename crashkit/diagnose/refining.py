"""What was found, fitted to more samples and seen on all of them; what that can do without is not told."""

from collections.abc import Mapping, Sequence

import xarray as xr
from attrs import evolve

from crashkit.diagnose.fitting.reidentify import refine
from crashkit.diagnose.fitting.search import STEPS, Search, begin
from crashkit.diagnose.fitting.sharpen import ROUGHLY, in_the_light_of, sharpened, weighed_alike
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.needed import needed, price
from crashkit.diagnose.name.rivals import CONCEALED
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.model import Model


def refined(workshop: Workshop, discovery: Discovery, model: Model, recordings: Mapping[str, xr.DataTree]) -> Discovery:
    """The base and the final model fitted to more samples, weighed alike, and seen on every sample.

    Open noise levels, and those that are louder than stated, are now what the final model leaves. What that fit can do without
    is not told. Numbers that the recordings do not see stay about where the user gave them.
    """
    workshop = workshop.equipped([discovery.base.model, discovery.final.model])
    start = discovery.final.start()
    found = discovery.final.reweighted(start).as_heard(start)
    thin = in_the_light_of(workshop, model, recordings, found)
    without, final = (workshop.misfit(thin, one.model) for one in (discovery.base, discovery.final))
    found_with = refine(workshop.identifier, final)
    found_without = _unexplained(workshop, without) if discovery.findings else found_with
    findings, *searches = needed(workshop, discovery.findings, found_without, found_with, workshop.misfit(thin, model))
    searches = [sharpened(workshop, model, recordings, search) for search in searches]
    full = weighed_alike(workshop.first_misfit(model, recordings), found)
    base, final = (workshop.misfit(full, search.fitted().model) for search in searches)
    believing = full.with_prior(ROUGHLY)
    if findings and _is_worthless(findings, *(workshop.misfit(believing, one.model) for one in (base, final))):
        findings, final, searches = (), base, [searches[0]] * 2
    last = discovery.findings[0] if discovery.findings and not findings else discovery.last
    return evolve(discovery, base=base, final=final, search=searches[1].unbelieving(), findings=findings, last=last)


def _unexplained(workshop: Workshop, misfit: Misfit) -> Search:
    """The fit of the model as it is. Where it leaves much, other starts are not worth their time: they would have to leave
    as little as a finding does."""
    search = begin(workshop.identifier, misfit).advance(STEPS)
    return search if search.normalised > CONCEALED else refine(workshop.identifier, misfit)


def _is_worthless(findings: Sequence[Look], base: Misfit, final: Misfit) -> bool:
    """Whether all samples, and what was believed of the numbers, show less than the findings cost: then these explained what
    thinning had left."""
    before, after = (misfit.deviance(misfit.residual(misfit.start())) for misfit in (base, final))
    return before - after < sum(price(look.leader.proposal, final) for look in findings)
