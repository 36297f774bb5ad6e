"""A load that meets the obstacle itself: the momentum that the carrier does not account for says how heavy it is, and when."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.integrate import cumulative_trapezoid

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_body, with_joint
from crashkit.protocols import Proposal
from crashkit_hypotheses.build import forward, free_paths, plane_inertia, proposal_at

PLASTIC = 50.0
"""Unloading over loading slope: a crushed structure gives hardly any energy back. The channels of a carrier cannot tell a load
that rebounds from one that stays, so this is a prior, not an estimate."""
SHARES = (0.05, 0.5)
"""Of the carrier's mass, that a load may have."""
REST = (0.5, 1.05)
"""Of the carrier's stated mass, what it may have without its load: the heaviest leaves it half. As the stated mass may be too
small, it may also have a little more."""
ONSET = 0.1
"""Of the greatest force that the carrier does not balance, where it sets in: less may be noise, or a wrong mass."""
FORMS = ("contact", "crushing_contact")
LIGHT = (0.3, 0.5, 0.8)
"""Masses to start from, relative to the momentum's."""
NEAR = (1.0, 0.8)
"""Gaps to start from: a soft first contact hides in the model's own forces."""
MOUNT_PERIODS = (0.3, 0.14, 0.07)
"""s, of the load on its mount."""
LENGTHS = ("clearance", "densification_deformation")
"""Of a contact: they do not grow with the load."""
FAR = Parameter(1e3, fixed=True)


@frozen
class Meeting:
    """What the recorded force on the obstacle and the carrier's motion say of a load.

    With R = F + m a, the force on the obstacle that the carrier's own deceleration does not balance:

    Attributes:
        mass: of the load, kg: the impulse of R over the carrier's velocity, where the impulse is greatest.
        gap: m, the carrier's way when R sets in; the load has moved with it until then.
        travel: m, of the load while R acts.
        force: N, the greatest R.
        way: m, the carrier's whole way.
    """

    mass: float
    gap: float
    travel: float
    force: float
    way: float


def meeting(recording: xr.DataTree, carrier: Body, mass: float, obstacles: Sequence[str]) -> Meeting | None:
    """The load's meeting with what stops the carrier; None where the channels are missing or no such load is seen."""
    known = _channels(recording, carrier.name, obstacles)
    if known is None:
        return None
    time, acceleration, force, velocity = known
    residual = force + mass * acceleration
    velocity = velocity + cumulative_trapezoid(acceleration, time, initial=0.0)
    way, impulse = (cumulative_trapezoid(rate, time, initial=0.0) for rate in (velocity, residual))
    end = int(np.argmax(impulse))
    load = impulse[end] / velocity[end] if velocity[end] > 0.0 else 0.0
    if not SHARES[0] * mass < load < SHARES[1] * mass:
        return None
    peak = int(np.argmax(residual[: end + 1]))
    quiet = np.flatnonzero(residual[:peak] < ONSET * residual[peak])
    start = int(quiet[-1]) + 1 if len(quiet) else 0
    travel = 0.5 * velocity[start] * (time[end] - time[start])
    return Meeting(float(load), float(way[start]), float(travel), float(residual[peak]), float(way.max()))


def meets_obstacle(model: Model, carrier: Body, mass: float, recordings: Sequence[xr.DataTree]) -> Iterator[Proposal]:
    """A load on the carrier that meets a fixed body which the carrier is joined to; its mass is taken out of the carrier.

    Of an obstacle in parts, as the rows of a wall of load cells, all parts together say when and how it meets one of them.
    """
    obstacles = _obstacles(model, carrier.name)
    seen = [meeting(recording, carrier, mass, obstacles) for recording in recordings] if obstacles else []
    found = next((one for one in seen if one is not None), None)
    if found is not None:
        yield from (_proposal(model, carrier, mass, part, found, form) for part in obstacles for form in FORMS)


def _obstacles(model: Model, carrier: str) -> list[str]:
    fixed = [body.name for body in model.bodies if body.fixed]
    return [name for name in fixed if any({name, carrier} == set(joint.bodies) for joint in model.joints)]


def _proposal(model: Model, carrier: Body, mass: float, obstacle: str, found: Meeting, form: str) -> Proposal:
    load = _load(model, carrier, mass, found)
    law = _crushed(found) if form == "crushing_contact" else _contact(found)
    # Deformation grows as the first body moves on towards the second.
    mount = _joint(model, carrier, f"{load.name}_mount", (carrier.name, load.name), _mount(found))
    contact = _joint(model, carrier, f"{load.name}_contact", (load.name, obstacle), law)
    rest = f"body.{carrier.name}.mass"
    lighter = model.with_parameters({rest: Parameter(mass - found.mass, REST[0] * mass, REST[1] * mass)})
    paths = {"rest": rest, "load": f"body.{load.name}.mass"}
    paths |= {f"mount.{key}": path for key, path in free_paths(mount).items()}
    paths |= {f"contact.{key}": path for key, path in free_paths(contact).items()}
    return proposal_at(
        physics="carried_load",
        form=form if len(_obstacles(model, carrier.name)) == 1 else f"{form} with {obstacle}",
        location={"body": carrier.name},
        model=with_joint(with_joint(with_body(lighter, load), mount), contact),
        paths=paths,
        starts=_starts(mass, found, law),
    )


def _load(model: Model, carrier: Body, mass: float, found: Meeting) -> Body:
    name = fresh_name(f"{carrier.name}_load", (b.name for b in model.bodies))
    weight, inertia = Parameter(found.mass, SHARES[0] * mass, SHARES[1] * mass), plane_inertia(model, found.mass)
    return Body(name, carrier.position, carrier.velocity, weight, carrier=carrier.name, inertia=inertia)


def _joint(model: Model, carrier: Body, name: str, ends: tuple[str, str], law: Mapping[str, Parameter]) -> Joint:
    name = fresh_name(name, (j.name for j in model.joints))
    return Joint(name, ends, "crush_plateau", dict(law), normal=forward(model, carrier))


def _mount(found: Meeting) -> dict[str, Parameter]:
    """The carrier runs up on its load: compression only, and plastic."""
    stiffness = _mount_stiffness(found.mass, min(MOUNT_PERIODS))
    return {
        "elastic_stiffness": Parameter(stiffness, 1e-2 * stiffness, 1e2 * stiffness),
        "crush_force": Parameter(1e12, fixed=True),
        "densification_deformation": FAR,
        "densification_stiffness": Parameter(1.0, fixed=True),
        "unloading_stiffness": Parameter(PLASTIC * stiffness, fixed=True),
    }


def _contact(found: Meeting) -> dict[str, Parameter]:
    """A slope behind a gap, plastic."""
    stiffness = 2.0 * found.force / found.travel
    return {
        **_mount(found),
        "elastic_stiffness": Parameter(stiffness, 5e-3 * stiffness, 10.0 * stiffness),
        "unloading_stiffness": Parameter(PLASTIC * stiffness, fixed=True),
        "clearance": Parameter(found.gap, 0.0, max(found.way, found.gap)),
    }


def _crushed(found: Meeting) -> dict[str, Parameter]:
    """The same with a plateau and densification."""
    stiffness = 2.0 * found.force / found.travel
    return {
        **_contact(found),
        "crush_force": Parameter(0.5 * found.force, 1e-2 * found.force, 5.0 * found.force),
        "densification_deformation": Parameter(0.5 * found.travel, 1e-3, max(found.way, 2e-3)),
        "densification_stiffness": Parameter(stiffness, 5e-3 * stiffness, 10.0 * stiffness),
    }


def _mount_stiffness(mass: float, period: float) -> float:
    return mass * (2.0 * np.pi / period) ** 2


def _starts(mass: float, found: Meeting, contact: Mapping[str, Parameter]) -> Iterator[dict[str, float]]:
    """Loads lighter than the momentum says, their forces in proportion: the model's own forces still bear part of the load."""
    forces = {key: one.value for key, one in contact.items() if not one.fixed and key not in LENGTHS}
    for light, near, period in product(LIGHT, NEAR, MOUNT_PERIODS):
        load = light * found.mass
        yield {
            "rest": mass - load,
            "load": load,
            "mount.elastic_stiffness": _mount_stiffness(load, period),
            **{f"contact.{key}": light * value for key, value in forces.items()},
            "contact.clearance": near * found.gap,
        }


def _channels(recording: xr.DataTree, carrier: str, obstacles: Sequence[str]) -> tuple[np.ndarray, ...] | None:
    """Times, the carrier's acceleration, the force on all obstacles, the carrier's first velocity; towards them positive."""
    acceleration = _channel(recording, "accelerometer", "acceleration", carrier)
    forces = [_channel(recording, "load_cell", "force", obstacle) for obstacle in obstacles]
    state = recording.children.get("initial")
    if acceleration is None or state is None or carrier not in state.to_dataset()["body"].values:
        return None
    velocity = float(state.to_dataset()["velocity"].sel(body=carrier).isel(axis=0))
    sense, time = np.sign(velocity), acceleration[0]
    pushed = [np.interp(time, *force) for force in forces if force is not None]
    if len(pushed) < len(forces):
        return None
    return time, sense * acceleration[1], sense * np.sum(pushed, axis=0), np.array(abs(velocity))


def _channel(recording: xr.DataTree, observer: str, quantity: str, body: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Time stamps and samples of the first complete channel on a body."""
    for node in (child.to_dataset(inherit=False) for child in recording.children.values()):
        if node.attrs.get("observer") != observer:
            continue
        for sensor in np.flatnonzero(node["sensor_body"].values == body):
            samples = node[quantity].transpose("time", "sensor", "axis").values[:, sensor, 0]
            present = np.isfinite(samples)
            if present.sum() > 1:
                return node["time"].values[present], samples[present]
    return None
