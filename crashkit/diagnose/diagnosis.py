"""The diagnosis: re-identify, compare, locate, name, model, show."""

import math
from collections.abc import Mapping, Sequence

import xarray as xr
from attrs import evolve

from crashkit.campaign import one_thread
from crashkit.diagnose.claims import Progress
from crashkit.diagnose.fitting.evidence import UNEXPLAINED, explains, is_at_noise, is_strained
from crashkit.diagnose.fitting.in_time import TimeLimit, in_time
from crashkit.diagnose.fitting.reidentify import reidentify
from crashkit.diagnose.fitting.search import STEPS, begin
from crashkit.diagnose.fitting.sharpen import ROUGHLY, as_heard, in_the_light_of, sharpened
from crashkit.diagnose.fitting.thinning import thinned_by
from crashkit.diagnose.fitting.thresholds import awake
from crashkit.diagnose.holdout import asks_again, fitted_together, leading_looks, says_more
from crashkit.diagnose.locate.aside import are_at_odds
from crashkit.diagnose.name.discover import discover
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.pace import OutrunError
from crashkit.diagnose.name.twins import beside_twins
from crashkit.diagnose.refining import refined
from crashkit.diagnose.result import Diagnosis
from crashkit.diagnose.show.answer import answer
from crashkit.diagnose.show.words import cut_short, not_simulated, nothing_predicted
from crashkit.diagnose.workshop import Workshop
from crashkit.errors import SimulationError
from crashkit.misfit import fine_step
from crashkit.model import Model


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
    try:
        together = None if limit.is_over else fitted_together(equipped, discovery, model, recordings, holdout)
        if together is not None and asks_again(discovery, together):
            looks = leading_looks(discovery)
            again, asked_again = _discovered_in(rehearsed, model, {**recordings, **holdout}, limit, looks)
            if says_more(discovery, asked_again, together) and (not limit.is_over or explains(asked_again.search)):
                told = nothing_predicted(answer(again, asked_again, model, {}), tuple(holdout), is_at_noise(together))
                return cut_short(told, seconds) if limit.is_over else told
        told = answer(equipped, discovery, model, holdout, together)
    except SimulationError as error:
        if not holdout:
            raise
        told = not_simulated(answer(equipped, discovery, model, {}), tuple(holdout), error)
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
    base = reidentify(equipped, given, everywhere=not are_at_odds(given))
    # What strained numbers ask of the rate, the structure does not.
    if not is_strained(base):
        base = sharpened(equipped, model, recordings, base)
    base = as_heard(base)
    awake_given = base.misfit.with_values_of(awake(equipped, given, base))
    discovery = _discovered_at_pace(Inquiry(equipped, awake_given, base, progress, recordings), looks)
    progress.show("refining", 0.0)
    discovery = beside_twins(equipped, discovery)
    # What was found may move faster than the model as it was given.
    equipped = evolve(equipped, step=min(equipped.step, fine_step(discovery.final)))
    return equipped, refined(equipped, discovery, model, recordings)


def _discovered_at_pace(inquiry: Inquiry, looks: Sequence[Look]) -> Discovery:
    """What is found in time; where that outruns the recordings as they were thinned, by finer ones.

    What had been found before still counts where all that is found in time by these plainly leaves more.
    """
    base, workshop = inquiry.base, inquiry.workshop
    try:
        return in_time(Discovery.of(base, base), discover, inquiry, looks)
    except OutrunError as outrun:
        found, beside = outrun.found, outrun.beside
    workshop = evolve(workshop, step=min(workshop.step, fine_step(found.search.fitted())))
    thin = in_the_light_of(workshop, inquiry.given.model, inquiry.unthinned, found.search.fitted())
    base = begin(workshop.identifier, thin.with_values(base.values)).advance(STEPS)
    findings = (*beside, Look((found,), (1.0,), 0.0, base.fitted()))
    finer = Inquiry(workshop, base.misfit.with_values_of(inquiry.given), base, inquiry.progress)
    before = Discovery.of(base, found.search, findings)
    told = in_time(before, discover, finer, findings, stand=True)
    is_worse = told.search.normalised > max(UNEXPLAINED, before.search.normalised)
    return before if is_worse else told
