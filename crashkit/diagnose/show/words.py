"""The answer in about ten lines that a person can read, and the notes on what cannot be trusted."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.data.filter_ends import unsettled
from crashkit.diagnose.fitting.evidence import FLOOR
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.result import IN_WORDS, Diagnosis, Estimate, Finding, Fit, place_of
from crashkit.diagnose.show.fits import is_beyond, is_explained, is_worse
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.model import Model, Parameter
from crashkit.protocols import Identification

VERDICTS = {
    "consistent": "Simulation and recordings agree: nothing is missing that these recordings could show.",
    "missing_physics": "Simulation and recordings differ: the model leaves out physics.",
    "sensor_fault": "Simulation and recordings differ: an instrument is wrong, not the structure.",
    "unexplained": "Simulation and recordings differ, and none of the known physics explains it.",
}

UNASKED = "Simulation and recordings differ; what explains it was not found in the time that was given."

MOST_LIMITS = 5
FAR = 0.9
"""Relative distance of a number from what was given that is worth a note: three times what it is believed to."""


def summarise(
    verdict: str,
    findings: Sequence[Finding],
    fits: Mapping[str, Mapping[str, Fit]],
    consistency: xr.Dataset,
    detectable: xr.Dataset,
) -> str:
    """The verdict, each finding with its numbers, and the fits; where nothing was found, what would have been."""
    lines = [VERDICTS[verdict], *(_lines_of_limits(detectable) if not findings else [])]
    for finding in findings:
        lines += _lines_of(finding)
    lines.append("Residual over noise (1 is the noise floor), re-identified model -> with what was found:")
    for name, label in (("calibration", "fitted runs"), ("holdout", "held-out runs")):
        if fits[name]:
            lines.append(f"  {label}: {fits[name]['before'].normalised_rmse:.3f} -> {fits[name]['after'].normalised_rmse:.3f}")
    lines += [f"  {sentence}" for sentence in of_prediction(fits["holdout"])]
    if consistency.sizes.get("check", 0):
        worst = int(np.argmax(consistency["sigma"].values))
        lines.append(f"Instruments by kinematics alone: {consistency['sentence'].values[worst]}")
    return "\n".join(lines)


def noted(discovery: Discovery, result: Identification, fits: Mapping[str, Mapping[str, Fit]]) -> tuple[str, ...]:
    """What cannot be trusted."""
    notes = [f"identification {result.status.value}"] if result.status.name != "CONVERGED" else []
    notes += list(result.unseen)
    left = fits["calibration"]["after"].normalised_rmse
    if discovery.findings and left > FLOOR:
        notes.append(f"what was found leaves {left:.2f} times the noise: the form of its law may be another, or there is more")
    notes += [str(discovery.pointer)] if discovery.findings and discovery.pointer else []
    notes += of_prediction(fits["holdout"])
    notes += _of_loud_channels(discovery.final)
    notes += _of_made_up_ends(discovery.final)
    open_levels = sorted({f"{c.instrument}/{c.sensor}" for c in discovery.final.channels if not c.noise.trusted})
    if open_levels:
        samples = discovery.final.independent_samples
        notes.append(
            f"the noise of {', '.join(open_levels)} is not given and the channels are filtered: residuals are weighed by "
            f"their own size, and all channels together count as about {samples:.0f} independent samples"
        )
    return tuple(notes)


def _of_loud_channels(final: Misfit) -> list[str]:
    louder = {f"{c.instrument}/{c.sensor}": c.noise.louder for c in final.channels if c.noise.louder > 1.0}
    return [
        f"the noise of {sensor} is {times:.2g} times what is stated, or estimated: what is left is white, and weighed so"
        for sensor, times in sorted(louder.items())
    ]


def _of_made_up_ends(final: Misfit) -> list[str]:
    ends = {(group.name, unsettled(group.dataset, group.observer.quantity)) for group in final.groups}
    return [
        f"the first and last {1e3 * seconds:.2g} ms of {name} count as missing: "
        "its filter was not told of the rest before the impact"
        for name, seconds in sorted(ends)
        if seconds
    ]


def far_off(given: Model, final: Model) -> list[str]:
    """The numbers of the given model that came out far from where they were given."""
    found = final.free_parameters()
    pairs = [(path, start, found[path].value) for path, start in given.free_parameters().items() if path in found]
    return [
        f"{path} came out at {value:.4g}, far from the {start.value:.4g} that was given: it may stand in for something that "
        "the model lacks"
        for path, start, value in pairs
        if _distance(start, value) > FAR
    ]


def _distance(start: Parameter, value: float) -> float:
    """From what was given, relative to that, or in its logarithm where that is searched; nothing is known of zeros."""
    if start.value == 0.0:
        return 0.0
    return abs(math.log(value / start.value)) if start.lower > 0.0 else abs(value - start.value) / abs(start.value)


def of_prediction(fits: Mapping[str, Fit]) -> list[str]:
    """Why the held-out runs are predicted as badly as they are."""
    if not fits or fits["after"].normalised_rmse < FLOOR:
        return []
    expected = fits["after"].expected_rmse
    sentences = []
    if is_worse(fits):
        sentences.append(
            "The held-out runs are predicted worse than before: do not trust this outside the runs that were fitted."
        )
    if is_explained(fits):
        sentences.append(_told_by_all_runs(fits["after"]))
    elif is_beyond(fits):
        sentences.append(
            f"Of the right model about {expected:.2f} times the noise is to be expected there: a law has another form than "
            "the model says, or something is missing."
        )
    elif expected > FLOOR:
        sentences.append(
            f"The fitted runs foretell the held-out ones only to about {expected:.2g} times the noise; what they do not tell "
            f"is mostly {fits['after'].untold}."
        )
    return sentences


def _told_by_all_runs(fit: Fit) -> str:
    most = f", mostly {fit.untold}" if fit.expected_rmse > FLOOR else ""
    return (
        f"Fitted to these as well, the same model explains all runs ({fit.together_rmse:.2f} times the noise): nothing else "
        f"is missing, but the fitted runs alone do not tell all of its numbers{most}."
    )


def cut_short(diagnosis: Diagnosis, seconds: float) -> Diagnosis:
    """The diagnosis that could not ask everything, and says so."""
    sentence = f"the time for questions was up after {seconds:.0f} s: other causes or forms, or more of them, may fit better"
    summary = diagnosis.summary.replace(VERDICTS["unexplained"], UNASKED)
    notes = (sentence, *diagnosis.notes)
    return evolve(diagnosis, summary=f"{summary}\n{sentence}", notes=notes, time_up=seconds)


def nothing_predicted(diagnosis: Diagnosis, runs: Sequence[str], at_other_values: bool) -> Diagnosis:
    """The diagnosis that had to fit the runs that were held out, and says so.

    Arguments:
        at_other_values: whether what explained the other runs explains these beside them, too, only not as it had foretold.
    """
    how = "explains this only at other values of its" if at_other_values else "cannot explain this beside them, whatever its"
    sentence = (
        f"{', '.join(runs)}: what explains the other runs {how} numbers, so it was fitted too; nothing here was predicted, "
        "hold another run out"
    )
    return evolve(diagnosis, summary=f"{diagnosis.summary}\n{sentence}", notes=(sentence, *diagnosis.notes))


def not_simulated(diagnosis: Diagnosis, runs: Sequence[str], error: SimulationError) -> Diagnosis:
    """The diagnosis of a model that cannot be simulated in the runs that were held out, and says so."""
    sentence = f"{', '.join(runs)}: not predicted, as that cannot be simulated: {error}"
    return evolve(diagnosis, summary=f"{diagnosis.summary}\n{sentence}", notes=(sentence, *diagnosis.notes))


def _lines_of_limits(detectable: xr.Dataset) -> list[str]:
    """The first few kinds of physics, each at the place where it would have been seen soonest."""
    if not detectable.sizes.get("effect", 0):
        return []
    rows = zip(
        *(detectable[name].values.tolist() for name in ("physics", "place", "parameter", "smallest", "units")), strict=True
    )
    best: dict[str, tuple[str, str, float, str]] = {}
    for physics, place, parameter, smallest, unit in rows:
        if physics not in best or smallest < best[physics][2]:
            best[physics] = (place, parameter, smallest, "" if unit == "1" else f" {unit}")
    told = [f"  {what} at {row[0]}: {row[1]} {row[2]:.2g}{row[3]}" for what, row in list(best.items())[:MOST_LIMITS]]
    return ["It would have been found from about:", *told]


def number(estimate: Estimate) -> str:
    """A value with its deviation and unit, to the digits that mean something."""
    unit = "" if estimate.units == "1" else f" {estimate.units}"
    if not math.isfinite(estimate.std):
        return f"{estimate.value:.4g}{unit} (no interval)"
    if not estimate.identifiable:
        return f"{estimate.value:.4g}{unit} (not identifiable)"
    return f"{estimate.value:.4g} ± {estimate.std:.2g}{unit}"


def _lines_of(finding: Finding) -> list[str]:
    lines = [f"- {finding.physics} ({finding.form}) at {place_of(finding.location)}, probability {finding.probability:.3f}:"]
    lines.append(f"  {finding.sentence}; " + ", ".join(f"{name} {number(e)}" for name, e in _main(finding)))
    if finding.alternatives and finding.alternatives[0].probability > IN_WORDS:
        rival = finding.alternatives[0]
        test = f"; {finding.experiment}" if finding.experiment else ""
        lines.append(f"  or {rival.physics} at {place_of(rival.location)} ({rival.probability:.3f}){test}")
    if finding.is_split:
        lines.append(f"  {finding.physics}, at one of these places: {finding.anywhere:.3f}")
    return lines


def _main(finding: Finding) -> list[tuple[str, Estimate]]:
    """The first few parameters; the entries of a table say little by themselves."""
    return [(name, estimate) for name, estimate in finding.parameters.items() if "[" not in name][:4]
