"""A load that meets the obstacle itself: the momentum that the carrier does not account for says how heavy it is, and when."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_body, with_joint
from crashkit.protocols import Proposal
from crashkit_hypotheses.build import forward, plane_inertia

PLASTIC = 50.0
"""Unloading over loading slope: a crushed structure gives hardly any energy back. The channels of a carrier cannot tell a load
that rebounds from one that stays, so this is a prior, not an estimate."""
SHARES = (0.05, 0.5)
"""Of the carrier's mass, that a load may have."""
FORMS = ("contact", "crushing_contact")
LIGHT = (0.3, 0.5, 0.8)
"""Masses to start from, relative to the momentum's."""
NEAR = (1.0, 0.8)
"""Gaps to start from: a soft first contact hides in the model's own forces."""
MOUNT_PERIODS = (0.3, 0.14, 0.07)
"""s, of the load on its mount."""
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
    velocity = velocity + _integral(acceleration, time)
    way, impulse = _integral(velocity, time), _integral(residual, time)
    end = int(np.argmax(impulse))
    load = impulse[end] / velocity[end] if velocity[end] > 0.0 else 0.0
    if not SHARES[0] * mass < load < SHARES[1] * mass:
        return None
    peak = int(np.argmax(residual[: end + 1]))
    quiet = np.flatnonzero(residual[:peak] < 0.1 * residual[peak])
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
    load = fresh_name(f"{carrier.name}_load", (b.name for b in model.bodies))
    mount, contact = (fresh_name(f"{load}_{kind}", (j.name for j in model.joints)) for kind in ("mount", "contact"))
    rest = Parameter(mass - found.mass, 0.5 * mass, 1.05 * mass)
    weight = Parameter(found.mass, SHARES[0] * mass, SHARES[1] * mass)
    lighter = evolve(model, bodies=tuple(evolve(b, mass=rest) if b.name == carrier.name else b for b in model.bodies))
    inertia = plane_inertia(model, found.mass)
    augmented = with_body(
        lighter, Body(load, carrier.position, carrier.velocity, weight, carrier=carrier.name, inertia=inertia)
    )
    # Deformation grows as the first body moves on towards the second.
    laws = {mount: _mount(found), contact: _crushed(found) if form == "crushing_contact" else _contact(found)}
    for name, bodies in ((mount, (carrier.name, load)), (contact, (load, obstacle))):
        joint = Joint(name, bodies, "crush_plateau", laws[name], normal=forward(model, carrier))
        augmented = with_joint(augmented, joint)
    masses = (f"body.{carrier.name}.mass", f"body.{load}.mass")
    free = {f"joint.{name}.{key}": value for name, law in laws.items() for key, value in law.items() if not value.fixed}
    starts = tuple(_starts(masses, mount, contact, free, mass, found))
    form = form if len(_obstacles(model, carrier.name)) == 1 else f"{form} with {obstacle}"
    return Proposal("carried_load", form, {"body": carrier.name}, augmented, (*masses, *free), {}, starts)


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


def _starts(
    masses: tuple[str, str], mount: str, contact: str, free: Mapping[str, Parameter], mass: float, found: Meeting
) -> Iterator[dict[str, float]]:
    """Loads lighter than the momentum says, their forces in proportion: the model's own forces still bear part of the load."""
    forces = {path: value.value for path, value in free.items() if not path.endswith(("clearance", "deformation"))}
    for light, near, period in product(LIGHT, NEAR, MOUNT_PERIODS):
        load = light * found.mass
        yield {
            masses[0]: mass - load,
            masses[1]: load,
            **{path: light * value for path, value in forces.items()},
            f"joint.{mount}.elastic_stiffness": _mount_stiffness(load, period),
            f"joint.{contact}.clearance": near * found.gap,
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


def _integral(samples: np.ndarray, time: np.ndarray) -> np.ndarray:
    """From the first time stamp on, by the trapezoidal rule."""
    steps = 0.5 * (samples[1:] + samples[:-1]) * np.diff(time)
    return np.concatenate([[0.0], np.cumsum(steps)])
