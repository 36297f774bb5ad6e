"""What a finding adds at its place, and what the recordings ask for there."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.locate.forces import binned, missing_force, on_joint, recorded_motion
from crashkit.diagnose.workshop import Workshop
from crashkit.mechanics.along import forces_along
from crashkit.misfit import Misfit
from crashkit.model import Model


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
    return without.at({path: known[path].value for path in without.free_parameters() if path in known})


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
