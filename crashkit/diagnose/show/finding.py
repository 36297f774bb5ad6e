"""From the rival that won to a finding: when it acts, in which runs, how sure, and what would separate its rivals."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.result import UNKNOWN, Alternative, Estimate, Finding, own_name, place_of
from crashkit.protocols import Hypothesis, Identification

ACTIVE = 0.1
"""Share of its largest force from which an effect counts as acting."""
RUN_DROP = 9.0
"""Drop in chi squared that a run must show by itself to be named."""


def estimates(rival: Rival, identified: Identification, given: Collection[str] = ()) -> dict[str, Estimate]:
    """The new parameters by their own names, as identified in the final model.

    Arguments:
        given: paths of the given model's parameters.
    """
    table = identified.parameters
    known = set(table["parameter"].values.tolist())
    paths = [path if path in known else _elsewhere(known - set(given), path, rival) for path in rival.proposal.parameters]
    rows = {path: table.sel(parameter=path) for path in paths if path in known}
    short = [own_name(path) for path in rows]
    told = {path: name if short.count(name) == 1 else path for path, name in zip(rows, short, strict=True)}
    return {told[path]: _estimate(row) for path, row in rows.items()}


def _estimate(row: xr.Dataset) -> Estimate:
    """One row of the table; a number that may be off by more than its bounds allow is not told, whatever its interval."""
    std, room = float(row["std"]), float(row["upper"]) - float(row["lower"])
    return Estimate(float(row["value"]), std, str(row["units"].values), bool(row["identifiable"]) and not std > room)


def _elsewhere(known: Collection[str], path: str, rival: Rival) -> str:
    """Of a number of a joint: it stands in the law of that or beside it, as the other findings there leave room."""
    joint, name = rival.proposal.location.get("joint"), own_name(path)
    places = (f"joint.{joint}.{name}", f"joint.{joint}_{rival.proposal.physics}.{name}")
    return next((one for one in places if one in known), path)


def make_finding(
    rival: Rival,
    kind: type[Hypothesis],
    parameters: Mapping[str, Estimate],
    probability: float,
    alternatives: Sequence[Alternative],
    action: Mapping[str, xr.Dataset],
    run_drops: Mapping[str, float],
    end: float,
) -> Finding:
    """The finding in full.

    Arguments:
        action: what the finding adds, by run: `modelled_force` and `deformation_rate` over time; empty for sensors.
        run_drops: drop in chi squared of each run when the finding is let in.
        end: s, of the recordings; an instrument's fault lasts throughout.
    """
    place = rival.place
    start, stop, phase = _activity(action, end)
    named = tuple(run for run, drop in run_drops.items() if drop > RUN_DROP) or tuple(run_drops)
    strongest = _strongest(action) if rival.proposal.physics == UNKNOWN and action else ""
    return Finding(
        physics=rival.proposal.physics,
        form=rival.proposal.form,
        sentence=kind.sentence.format(place=place) + strongest,
        probability=probability,
        location=_told(rival.proposal.location),
        runs=named,
        time=(start, stop),
        phase=phase,
        parameters=parameters,
        alternatives=tuple(alternatives),
    )


def stand_ins(findings: Sequence[Finding], sentence: str) -> Finding:
    """Several findings at one place that together still leave something unexplained, as what they are: an estimated force.

    Each imitates a part of a force that no list has; none of them is there, but their sum predicts.

    Arguments:
        sentence: of an unknown force.
    """
    return evolve(
        findings[0],
        physics=UNKNOWN,
        form="imitated by " + " + ".join(f.physics for f in findings),
        sentence=sentence.format(place=place_of(findings[0].location)),
        probability=max(f.probability for f in findings),
        runs=tuple(dict.fromkeys(run for f in findings for run in f.runs)),
        time=(min(f.time[0] for f in findings), max(f.time[1] for f in findings)),
        parameters={name: value for f in findings for name, value in f.parameters.items()},
        experiment="",
    )


def _told(location: Mapping[str, object]) -> dict[str, object]:
    return {key: list(value) if isinstance(value, tuple) else value for key, value in location.items()}


def _strongest(action: Mapping[str, xr.Dataset]) -> str:
    """The largest force of an estimated law, when and where it acts."""
    run = max(action.values(), key=lambda one: float(np.nanmax(np.abs(one["modelled_force"].values))))
    at = run.isel(time=int(np.nanargmax(np.abs(run["modelled_force"].values))))
    force, deformation, rate = (float(at[name]) for name in ("modelled_force", "deformation", "deformation_rate"))
    when = f"{1e3 * float(at['time']):.0f} ms, a deformation of {1e3 * deformation:.0f} mm and {rate:.1f} m/s"
    return f", strongest with {1e-3 * force:.3g} kN at {when}"


def _activity(action: Mapping[str, xr.Dataset], end: float) -> tuple[float, float, str]:
    """From when to when it pushes noticeably, and whether mostly while the joint is loaded or unloaded."""
    if not action:
        return 0.0, end, "both"
    largest = max(float(np.nanmax(np.abs(one["modelled_force"]))) for one in action.values())
    starts, ends, loading, total = [], [], 0.0, 0.0
    for one in action.values():
        force = np.abs(one["modelled_force"].values)
        acting = force > ACTIVE * largest
        if acting.any():
            starts.append(float(one["time"].values[acting][0]))
            ends.append(float(one["time"].values[acting][-1]))
        loading += float(np.nansum(force[one["deformation_rate"].values > 0]))
        total += float(np.nansum(force))
    share = loading / total if total else 0.5
    phase = "loading" if share > 0.8 else "unloading" if share < 0.2 else "both"
    return min(starts, default=0.0), max(ends, default=end), phase
