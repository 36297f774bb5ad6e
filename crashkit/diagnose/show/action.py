"""What a finding adds at its place, and what the recordings ask for there."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.locate.forces import binned, missing_force, on_joint, recorded_motion
from crashkit.diagnose.workshop import Workshop
from crashkit.mechanics.along import forces_along
from crashkit.mechanics.joint_track import stretch_of
from crashkit.misfit import Misfit
from crashkit.model import Joint, Model


def action_of(
    workshop: Workshop, final: Misfit, without: Misfit, rival: Rival, unseen: tuple[Misfit, ...]
) -> dict[str, xr.Dataset]:
    """What a finding adds at its place, and what the recordings ask for there, by run; empty for a sensor."""
    joint = _joint_at(without.model, final.model, rival.proposal.location)
    if joint is None:
        return {}
    stripped = _stripped(without.model, final.model)
    sets = [(final, False), *([(unseen[1], True)] if unseen else [])]
    return {
        run: _action(workshop, misfit, run, stripped, joint).assign_attrs(place=rival.place, holdout=int(holdout))
        for misfit, holdout in sets
        for run in misfit.recordings
    }


def _action(workshop: Workshop, misfit: Misfit, run: str, stripped: Model, joint: Joint) -> xr.Dataset:
    simulated = misfit.predictor.motion(run, misfit.model.values())
    recorded = recorded_motion(misfit, run, simulated, workshop.smoother)
    stretch = stretch_of(misfit.model, evolve(joint, free_length=None), simulated)
    asked = on_joint(missing_force(stripped, workshop.laws, recorded), joint.pushed, stretch.direction)
    final, before = (forces_along(model, workshop.laws, simulated)["contact_force"] for model in (misfit.model, stripped))
    added = (final - before).sel(body=joint.pushed[1]).values
    times = simulated["time"].values
    instants, force, std = binned(times, asked)
    columns = {
        "missing_force": (force, "N"),
        "missing_force_std": (std, "N"),
        "modelled_force": (np.interp(instants, times, (added * stretch.direction).sum(axis=1)), "N"),
        "deformation": (np.interp(instants, times, stretch.length - stretch.distance), "m"),
        "deformation_rate": (np.interp(instants, times, stretch.rate), "m s-1"),
    }
    variables = {name: ("time", column, {"units": unit}) for name, (column, unit) in columns.items()}
    return xr.Dataset(variables, coords={"time": ("time", instants, {"units": "s"})})


def _stripped(without: Model, final: Model) -> Model:
    """The final model without one finding: the structure before it, at the final values."""
    known = final.parameters()
    return without.at({path: known[path].value for path in without.free_parameters() if path in known})


def _joint_at(without: Model, final: Model, location: Mapping[str, object]) -> Joint | None:
    """The joint along which a missing force acts: that of the place, or one by which the finding holds a body to the ground,
    or the line between two bodies; None for an obstacle, whose own motion nothing tells."""
    if "joint" in location:
        return without.joint(str(location["joint"]))
    bodies = _bodies_at(without, location)
    if bodies is None:
        return None
    known = [joint.name for joint in without.joints]
    grounded = (joint for joint in final.joints if joint.bodies[1] == bodies[1] and final.body(joint.bodies[0]).fixed)
    return next((joint for joint in grounded if joint.name not in known), Joint("", bodies, "", {}))


def _bodies_at(model: Model, location: Mapping[str, object]) -> tuple[str, str] | None:
    if "bodies" in location:
        pair = location["bodies"]
        assert isinstance(pair, list | tuple)  # as Proposal says
        return str(pair[0]), str(pair[1])
    if "body" in location:
        name = str(location["body"])
        fixed = next((body.name for body in model.bodies if body.fixed), None)
        return (fixed, name) if fixed and not model.body(name).fixed else None
    return None
