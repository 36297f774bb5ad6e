"""The answer: a verdict, findings with what they gain, and the curves behind them."""

import math
from collections.abc import Mapping, Sequence

import xarray as xr
from attrs import evolve

from crashkit.campaign import spread
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.leftover import leaves_something
from crashkit.diagnose.fitting.rebuild import rebuild
from crashkit.diagnose.fitting.search import Search, begin
from crashkit.diagnose.fitting.sharpen import ROUGHLY, weighed_alike
from crashkit.diagnose.locate.consistency import by_run, check_instruments
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import UNKNOWN, Alternative, Diagnosis, Finding, Fit
from crashkit.diagnose.show.action import action_of
from crashkit.diagnose.show.expected_error import expected_error
from crashkit.diagnose.show.experiment import experiment
from crashkit.diagnose.show.finding import estimates, make_finding, stand_ins
from crashkit.diagnose.show.fits import curves_of, fit_of, is_misleading, predict
from crashkit.diagnose.show.one_force import are_one_force
from crashkit.diagnose.show.run_drops import run_drops
from crashkit.diagnose.show.tables import identified_table, limits_table, ranking_table
from crashkit.diagnose.show.words import far_off, noted, summarise
from crashkit.diagnose.workshop import Workshop
from crashkit.misfit import Misfit
from crashkit.misfit.predictor import Prediction
from crashkit.model import Model
from crashkit.protocols import Identification

BELIEVED, INCOMPLETE = 0.97, 0.5
"""Shares of its probability with which a claim is told that explains everything, and one that leaves more or that the held-out
runs speak against: of 166 findings of unseen cases with at least 0.99, 97 % were there, and of 36 claims that left something
21; of six that the held-out runs spoke against, one. The evidence only compares what was tried."""
WORTH_TELLING = 1e-4
Told = tuple[Finding, dict[str, xr.Dataset]]
"""A finding, and by run what it adds."""


def answer(
    workshop: Workshop,
    discovery: Discovery,
    given: Model,
    holdout: Mapping[str, xr.DataTree],
    together: Search | None = None,
) -> Diagnosis:
    """What a discovery says of the runs that were fitted, and of those held out.

    Arguments:
        workshop: with the steps that the recordings need.
        given: the model as the user believes it.
        holdout: runs that are only predicted, by name.
        together: what was found, fitted to them as well, where that was asked.
    """
    base, final = discovery.base, discovery.final
    equipped = workshop.equipped([base.model, final.model])
    unseen = tuple(weighed_alike(equipped.first_misfit(m.model, holdout), base) for m in (base, final)) if holdout else ()
    fits, curves = _compared(base, final, unseen, together)
    result = discovery.search.result()
    explains = not leaves_something(final)
    belief = BELIEVED if explains and not is_misleading(fits["holdout"]) else INCOMPLETE
    findings, missing = _findings(equipped, discovery, result, unseen, belief)
    verdict = _verdict(findings, explains)
    consistency = check_instruments(by_run(base))
    identified = identified_table(discovery, result)
    detectable = limits_table(workshop, discovery)
    return Diagnosis(
        verdict=verdict,
        summary=summarise(verdict, findings, fits, consistency, detectable),
        findings=findings,
        base_model=base.model,
        augmented_model=final.model,
        fits=fits,
        curves=curves,
        missing_force=missing,
        ranking=ranking_table(discovery),
        consistency=consistency,
        identified=identified,
        notes=(*noted(discovery, result, fits), *far_off(given, final.model)),
        detectable=detectable,
    )


def _compared(
    base: Misfit, final: Misfit, unseen: tuple[Misfit, ...], together: Search | None
) -> tuple[dict[str, dict[str, Fit]], xr.DataTree]:
    sets = {"calibration": (base, final)} | ({"holdout": unseen} if unseen else {})
    fits: dict[str, dict[str, Fit]] = {"calibration": {}, "holdout": {}}
    curves: dict[str, xr.Dataset] = {}
    for name, pair in sets.items():
        predictions = predict(pair[0]), predict(pair[1])
        fits[name] = dict(zip(("before", "after"), spread(_fit, list(zip(pair, predictions, strict=True))), strict=True))
        curves |= curves_of(pair[0], pair[1], predictions, holdout=name == "holdout")
    if unseen:
        expected, untold = expected_error(final, unseen[1], ROUGHLY)
        all_runs = together.normalised if together else math.nan
        after = evolve(fits["holdout"]["after"], expected_rmse=expected, untold=untold, together_rmse=all_runs)
        fits["holdout"]["after"] = after
    return fits, xr.DataTree.from_dict(curves)


def _fit(predicted: tuple[Misfit, list[Prediction]]) -> Fit:
    return fit_of(*predicted)


def _findings(
    workshop: Workshop, discovery: Discovery, identified: Identification, unseen: tuple[Misfit, ...], belief: float
) -> tuple[tuple[Finding, ...], xr.DataTree]:
    told: list[Told] = []
    for look in discovery.findings:
        rival = look.leader
        action = action_of(workshop, discovery.final, look.before, rival, unseen)
        kind = workshop.hypotheses[rival.proposal.physics]
        finding = make_finding(
            rival,
            kind,
            estimates(rival, identified, discovery.base.names),
            belief * look.probabilities[0],
            _alternatives(look, belief),
            {run: one for run, one in action.items() if not one.attrs["holdout"]},
            run_drops(look.before, rival.search.fitted()),
            max(float(group.times[-1]) for group in discovery.final.groups),
        )
        told.append((_with_experiment(workshop, discovery, finding, look), action))
    if UNKNOWN in workshop.hypotheses:
        told = _imitations_told(told, discovery, workshop.hypotheses[UNKNOWN].sentence)
    trees = {f"{number}/{run}": one for number, (_, action) in enumerate(told) for run, one in action.items()}
    return tuple(finding for finding, _ in told), xr.DataTree.from_dict(trees)


def _imitations_told(told: list[Told], discovery: Discovery, sentence: str) -> list[Told]:
    """Findings at one place that imitate one force become one, with the force of the first."""
    places = dict.fromkeys(look.leader.place for look in discovery.findings)
    each = list(zip(told, discovery.findings, strict=True))
    together = [[(one, look) for one, look in each if look.leader.place == place] for place in places]
    return [one for some in together for one in _as_one(some, discovery, sentence)]


def _as_one(some: Sequence[tuple[Told, Look]], discovery: Discovery, sentence: str) -> list[Told]:
    told, findings = [one for one, _ in some], [finding for (finding, _), _ in some]
    if not are_one_force([look for _, look in some], findings, discovery.search):
        return told
    return [(stand_ins(findings, sentence), told[0][1])]


def _alternatives(look: Look, belief: float) -> list[Alternative]:
    """The other claims, as far as they are worth telling."""
    return [Alternative(r.proposal.physics, r.proposal.form, dict(r.proposal.location), belief * p) for r, p in _others(look)]


def _others(look: Look) -> list[tuple[Rival, float]]:
    """The rivals that are worth telling, the most probable first: twins stand before others, whatever their odds."""
    others = zip(look.rivals[1:], look.probabilities[1:], strict=True)
    return sorted((one for one in others if one[1] > WORTH_TELLING), key=lambda one: -one[1])


def _with_experiment(workshop: Workshop, discovery: Discovery, finding: Finding, look: Look) -> Finding:
    """The finding with the test that would tell it from its strongest rival, if that is worth telling."""
    known = _others(look)
    if not known:
        return finding
    first, second = look.leader, known[0][0]
    name = f"{second.proposal.physics} at {second.place}"
    others = [one.leader for one in discovery.findings if one is not look]
    beside = _beside(workshop, discovery, second, others) if others else None
    best, rival = beside or _seen_alike(workshop, first.search.fitted(), second.search.fitted())
    return evolve(finding, experiment=experiment(best, rival, name, discovery.base.model.bodies))


def _beside(workshop: Workshop, discovery: Discovery, rival: Rival, others: Sequence[Rival]) -> tuple[Misfit, Misfit] | None:
    """What was found, and a rival beside the other findings in their last forms: it was fitted beside earlier ones, which no
    test of the rival needs to tell apart. None if it cannot be placed there."""
    again = rebuild(workshop, begin(workshop.identifier, discovery.base), [*others, rival], rival.search)
    return None if again is None else (discovery.final, again.fitted())


def _seen_alike(workshop: Workshop, first: Misfit, second: Misfit) -> tuple[Misfit, Misfit]:
    """Two fits to all the instruments that either saw: one may have been made while an accelerometer was set aside."""
    fullest = max(first, second, key=lambda one: len(one.channels))
    equipped = workshop.equipped([first.model, second.model])
    return equipped.misfit(fullest, first.model), equipped.misfit(fullest, second.model)


def _verdict(findings: tuple[Finding, ...], explains: bool) -> str:
    named = [f for f in findings if f.physics != UNKNOWN]
    if any("joint" in f.location or "body" in f.location or "bodies" in f.location for f in named):
        return "missing_physics"
    if findings:
        return "unexplained" if len(named) < len(findings) else "sensor_fault"
    return "consistent" if explains else "unexplained"
