"""The tables and curves behind a diagnosis."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit.campaign import spread
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.locate.forces import binned, missing_force, on_joint, recorded_motion
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.result import own_name, place_of
from crashkit.diagnose.show.left_out import left_out_drop
from crashkit.diagnose.workshop import Workshop
from crashkit.mechanics.along import forces_along
from crashkit.misfit import Group, Misfit
from crashkit.model import Model
from crashkit.protocols import Identification, ParameterSpec, Proposal

LEADING = 3
"""Rivals of each round that are also asked for runs that they have not seen."""


def ranking_table(discovery: Discovery) -> xr.Dataset:
    """Every rival that was fitted, round by round; the first few also with how they predict runs that are left out."""
    looks = [*discovery.findings, *([discovery.last] if discovery.last else [])]
    leading = [(number, look.before, r) for number, look in enumerate(looks) for r in look.rivals[:LEADING]]
    drops = spread(lambda one: left_out_drop(one[1], one[2].search), leading)
    predicted = {(number, r.identity): drop for (number, _, r), drop in zip(leading, drops, strict=True)}
    rows = [
        (
            r.proposal.physics,
            r.proposal.form,
            r.place,
            number + 1,
            len(r.proposal.parameters),
            r.drop,
            p,
            predicted.get((number, r.identity), np.nan),
        )
        for number, look in enumerate(looks)
        for r, p in zip(look.rivals, look.probabilities, strict=True)
    ]
    names = ("physics", "form", "place", "round", "parameters", "misfit_drop", "probability", "left_out_drop")
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(names)
    return xr.Dataset({name: ("hypothesis", np.array(column)) for name, column in zip(names, columns, strict=True)})


def limits_table(workshop: Workshop, discovery: Discovery) -> xr.Dataset:
    """Of every claim that was not made, the smallest effect that the recordings would have shown."""
    limits = [one for one in (discovery.last.limits if discovery.last else ()) if np.isfinite(one.smallest)]
    rows = [_limit_row(workshop, discovery.final.groups, one.proposal, one.smallest) for one in limits]
    names = ("physics", "form", "place", "parameter", "smallest", "units")
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(names)
    return xr.Dataset({name: ("effect", np.array(column)) for name, column in zip(names, columns, strict=True)})


def _limit_row(
    workshop: Workshop, groups: Sequence[Group], proposal: Proposal, smallest: float
) -> tuple[str, str, str, str, float, str]:
    path = proposal.parameters[0]
    unit = units_of(proposal.model, groups, workshop).get(path, "")
    return proposal.physics, proposal.form, place_of(proposal.location), own_name(path), smallest, unit


def identified_table(discovery: Discovery, result: Identification, units: Mapping[str, str]) -> xr.Dataset:
    """The parameters of the final model, beside those of the re-identified one."""
    table = result.parameters
    names = [str(name) for name in table["parameter"].values]
    before = {name: p.value for name, p in discovery.base.model.free_parameters().items()}
    return table[["value", "std", "identifiable"]].assign(
        units=("parameter", np.array([units.get(name, "") for name in names], dtype=str)),
        before=("parameter", np.array([before.get(name, np.nan) for name in names])),
    )


def units_of(model: Model, groups: Iterable[Group], workshop: Workshop) -> dict[str, str]:
    """The unit of every parameter, by path; those of an error depend on the instrument, one of the groups."""
    units = {f"body.{body.name}.mass": "kg" for body in model.bodies}
    for joint in model.joints:
        units[f"joint.{joint.name}.free_length"] = "m"
        for law in (workshop.laws[name] for name in (joint.law, *joint.factors)):
            units |= {f"joint.{joint.name}.{spec.name}": spec.unit for spec in law.parameters}
    errors = {group.name: group.observer.errors for group in groups}
    for entry in model.instruments:
        specs = errors.get(entry.instrument, ())
        prefix = f"instrument.{entry.instrument}.{entry.sensor}."
        units |= {prefix + name: _unit(specs, name) for name in entry.parameters}
    return {path: units.get(path.split("[")[0], "") for path in model.parameters()}


def action_of(
    workshop: Workshop, final: Misfit, without: Misfit, rival: Rival, unseen: tuple[Misfit, ...]
) -> dict[str, xr.Dataset]:
    """What a finding adds at its place, and what the recordings ask for there, by run; empty for a sensor."""
    bodies = _bodies_at(without.model, rival.proposal.location)
    if bodies is None:
        return {}
    stripped = _stripped(without.model, final.model)
    sets = [(final, False), *([(unseen[1], True)] if unseen else [])]
    return {
        run: _action(workshop, misfit, run, stripped, bodies, rival.place, holdout)
        for misfit, holdout in sets
        for run in misfit.recordings
    }


def missing_force_tree(trees: Mapping[str, xr.Dataset]) -> xr.DataTree:
    """One group per finding and run."""
    return xr.DataTree.from_dict(dict(trees))


def _action(
    workshop: Workshop, misfit: Misfit, run: str, stripped: Model, bodies: tuple[str, str], place: str, holdout: bool
) -> xr.Dataset:
    values = {name: p.value for name, p in misfit.model.free_parameters().items()}
    simulated = misfit.predictor.motion(run, values)
    recorded = recorded_motion(misfit, run, simulated, workshop.smoother)
    asked = on_joint(missing_force(stripped, workshop.laws, recorded), stripped, bodies)
    final, before = (_net_on(of, workshop, simulated, bodies, place) for of in (misfit.model, stripped))
    added = final - before
    times = simulated["time"].values
    instants, force, std = binned(times, asked)
    deformation, rate = _approach(misfit.model, simulated, bodies)
    columns = {
        "missing_force": (force, "N"),
        "missing_force_std": (std, "N"),
        "modelled_force": (np.interp(instants, times, added), "N"),
        "deformation": (np.interp(instants, times, deformation), "m"),
        "deformation_rate": (np.interp(instants, times, rate), "m s-1"),
    }
    variables = {name: ("time", column, {"units": unit}) for name, (column, unit) in columns.items()}
    return xr.Dataset(variables, coords={"time": instants}, attrs={"place": place, "holdout": int(holdout)})


def _stripped(without: Model, final: Model) -> Model:
    """The final model without one finding: the structure before it, at the final values."""
    known = final.parameters()
    return without.with_values({path: known[path].value for path in without.free_parameters() if path in known})


def _bodies_at(model: Model, location: Mapping[str, object]) -> tuple[str, str] | None:
    """The two bodies that the missing force acts between; None for an obstacle, whose own motion nothing tells."""
    if "joint" in location:
        return model.joint(str(location["joint"])).bodies
    if "bodies" in location:
        pair = location["bodies"]
        assert isinstance(pair, list | tuple)  # as Proposal says
        return str(pair[0]), str(pair[1])
    if "body" in location:
        name = str(location["body"])
        fixed = next((body.name for body in model.bodies if body.fixed), None)
        return (fixed, name) if fixed and not model.body(name).fixed else None
    return None


def _net_on(model: Model, workshop: Workshop, motion: xr.Dataset, bodies: tuple[str, str], place: str) -> np.ndarray:
    """The force between two bodies; where one of them is the place itself, everything that acts on it."""
    forces = forces_along(model, workshop.laws, motion)
    if place == f"body {bodies[1]}":
        return -forces["contact_force"].sel(body=bodies[1]).isel(axis=0).values * _direction(model, bodies)
    joints = [joint.name for joint in model.joints if set(joint.pushed) == set(bodies)]
    return forces["force"].sel(joint=joints).sum("joint").values


def _approach(model: Model, motion: xr.Dataset, bodies: tuple[str, str]) -> tuple[np.ndarray, np.ndarray]:
    first, second = (motion.sel(body=name).isel(axis=0) for name in bodies)
    direction = -_direction(model, bodies)
    distance = direction * (second["position"].values - first["position"].values)
    return distance[0] - distance, -direction * (second["velocity"].values - first["velocity"].values)


def _direction(model: Model, bodies: tuple[str, str]) -> float:
    """+1 where the second body lies behind the first."""
    first, second = (model.body(name).position[0] for name in bodies)
    return -1.0 if second >= first else 1.0


def _unit(specs: Sequence[ParameterSpec], name: str) -> str:
    return next((spec.unit for spec in specs if spec.name == name), "")
