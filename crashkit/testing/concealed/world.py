"""The world that the recordings come from: point masses on a line, joined by whatever the secret says.

It deliberately shares nothing with the engine of crashkit: one leapfrog loop with a step far below every time scale.
"""

import copy
import math
from typing import Any

import numba
import numpy as np
from attrs import define, frozen

STEP = 5e-6  # s
STRIDE = 2  # steps between two stored states
GROUND = "ground"  # the body on which an obstacle stands that is not fixed

# Every effect that a joint can have, with the value at which it is absent.
JOINT_FIELDS: dict[str, float] = {
    "elastic_stiffness": 0.0,
    "crush_force": math.inf,
    "densification_deformation": math.inf,
    "densification_stiffness": 0.0,
    "unloading_stiffness": 0.0,
    "unloading_power": 1.0,
    "plastic_share": 1.0,
    "gap": 0.0,
    "gap_softness": 0.0,
    "rate_linear": 0.0,
    "rate_power_size": 0.0,
    "rate_power": 1.0,
    "rate_log_size": 0.0,
    "rate_log_reference": 1.0,
    "rate_hump_size": 0.0,
    "rate_hump_reference": 1.0,
    "damping": 0.0,
    "damping_quadratic": 0.0,
    "damping_always": 0.0,
    "peak_force": 0.0,
    "peak_deformation": 0.0,
    "peak_width": 1.0,
    "peak_round": 0.0,
    "fold_force": 0.0,
    "fold_length": 1.0,
    "fold_start": 0.0,
    "fold_decay": math.inf,
    "fold_sharp": 0.0,
    "bottom_force": 0.0,
    "bottom_deformation": math.inf,
    "bottom_reference": 1.0,
    "bottom_power": 1.0,
    "fracture_loss": 0.0,
    "fracture_deformation": math.inf,
    "fracture_width": 1.0,
    "tension_stiffness": 0.0,
    "tension_limit": math.inf,
    "branch_stiffness": 0.0,
    "branch_time": 1.0,
    "fading_share": 0.0,
    "fading_time": 1.0,
    "friction": 0.0,
    "friction_velocity": 1.0,
    "friction_always": 0.0,
    "pulse_force": 0.0,
    "pulse_time": 0.0,
    "pulse_width": 1.0,
    "pulse_frequency": 0.0,
}
BODY_FIELDS: dict[str, float] = {"position": 0.0, "moving": 1.0, "mobility": 0.0, "friction": 0.0, "friction_velocity": 1.0}

_JOINT = np.dtype(
    [("front", "i8"), ("back", "i8"), ("side", "f8"), ("length", "f8"), *((name, "f8") for name in JOINT_FIELDS)]
)
_BODY = np.dtype([(name, "f8") for name in BODY_FIELDS])


@define
class WorldJoint:
    """A joint of the world: the bodies at its ends, and the fields in which it differs from an absent one."""

    front: str
    back: str
    fields: dict[str, float]


@define
class World:
    """Bodies and joints with all their effects; `mobility` is 1 / mass, 0 for what is fixed."""

    bodies: dict[str, dict[str, float]]
    joints: dict[str, WorldJoint]

    def copy(self) -> "World":
        """A copy that can be changed on its own."""
        return copy.deepcopy(self)


@frozen
class Trace:
    """What really happened in one run.

    Arguments:
        time: s, (time,).
        position, acceleration: m, m s-2, (time,) by body.
        deformation, force: m, N, (time,) by joint, positive in compression.
        contact: N, (time,) by body, the sum of the joints on it; the ground under an obstacle does not count.
    """

    time: np.ndarray
    position: dict[str, np.ndarray]
    acceleration: dict[str, np.ndarray]
    deformation: dict[str, np.ndarray]
    force: dict[str, np.ndarray]
    contact: dict[str, np.ndarray]


def run(world: World, speed: float, duration: float) -> Trace:
    """Let the moving bodies hit with `speed` (m s-1) at t = 0 and follow them for `duration` (s)."""
    bodies, joints = _body_table(world), _joint_table(world)
    steps = int(round(duration / STEP / STRIDE)) * STRIDE + 1
    position, acceleration, deformation, force = _integrate(bodies, joints, speed, steps)
    time = np.arange(len(position)) * STEP * STRIDE
    contact = {name: np.zeros(len(time)) for name in world.bodies}
    for joint, side, column in zip(world.joints.values(), joints["side"], force.T, strict=True):
        if joint.front != GROUND:
            contact[joint.front] -= side * column
            contact[joint.back] += side * column
    return Trace(
        time,
        dict(zip(world.bodies, position.T, strict=True)),
        dict(zip(world.bodies, acceleration.T, strict=True)),
        dict(zip(world.joints, deformation.T, strict=True)),
        dict(zip(world.joints, force.T, strict=True)),
        contact,
    )


def _body_table(world: World) -> np.ndarray:
    table = np.zeros(len(world.bodies), _BODY)
    for row, fields in zip(table, world.bodies.values(), strict=True):
        for name, value in {**BODY_FIELDS, **fields}.items():
            row[name] = value
    return table


def _joint_table(world: World) -> np.ndarray:
    index = {name: number for number, name in enumerate(world.bodies)}
    table = np.zeros(len(world.joints), _JOINT)
    for row, joint in zip(table, world.joints.values(), strict=True):
        distance = world.bodies[joint.back]["position"] - world.bodies[joint.front]["position"]
        row["front"], row["back"] = index[joint.front], index[joint.back]
        row["side"], row["length"] = (1.0 if distance >= 0 else -1.0), abs(distance)
        for name, value in {**JOINT_FIELDS, **joint.fields}.items():
            row[name] = value
    return table


@numba.njit(cache=True)
def _loading_force(joint: Any, d: float) -> float:
    """The force of a first loading to deformation d > 0."""
    force = min(joint.elastic_stiffness * d, joint.crush_force)
    if d > joint.densification_deformation:
        force += joint.densification_stiffness * (d - joint.densification_deformation)
    if joint.peak_force != 0.0:
        distance = (d - joint.peak_deformation) / joint.peak_width
        force += joint.peak_force * (math.exp(-distance * distance) if joint.peak_round else max(0.0, 1.0 - abs(distance)))
    if joint.fold_force != 0.0 and d > joint.fold_start:
        travel = d - joint.fold_start
        wave = math.sin(2.0 * math.pi * travel / joint.fold_length)
        wave = 2.0 / math.pi * math.asin(wave) if joint.fold_sharp else wave
        force += joint.fold_force * wave * math.exp(-travel / joint.fold_decay)
    if d > joint.bottom_deformation:
        force += joint.bottom_force * ((d - joint.bottom_deformation) / joint.bottom_reference) ** joint.bottom_power
    return max(force, 0.0)


@numba.njit(cache=True)
def _static_force(joint: Any, d: float, d_max: float) -> float:
    """The force without rate, memory of time, damping or friction; negative where the joint pulls."""
    top = _loading_force(joint, d_max)
    free = 0.0 if joint.unloading_stiffness == 0.0 else d_max - top / joint.unloading_stiffness
    if d <= free:
        force = -min(joint.tension_stiffness * (free - d), joint.tension_limit)
        return (
            force if joint.plastic_share == 1.0 else force + (1.0 - joint.plastic_share) * _loading_force(joint, max(d, 0.0))
        )
    if joint.unloading_stiffness == 0.0 or d >= d_max:
        return _loading_force(joint, d)
    plastic = top * ((d - free) / (d_max - free)) ** joint.unloading_power
    return joint.plastic_share * plastic + (1.0 - joint.plastic_share) * _loading_force(joint, max(d, 0.0))


@numba.njit(cache=True)
def _rate_factor(joint: Any, rate: float) -> float:
    factor = 1.0 + joint.rate_linear * rate
    if rate > 0.0:
        if joint.rate_power_size != 0.0:
            factor += joint.rate_power_size * (rate / 10.0) ** joint.rate_power
        if joint.rate_log_size != 0.0:
            factor += joint.rate_log_size * math.log(1.0 + rate / joint.rate_log_reference)
        if joint.rate_hump_size != 0.0:
            relative = rate / joint.rate_hump_reference
            factor += joint.rate_hump_size * relative * math.exp(1.0 - relative)
    return max(factor, 0.0)


@numba.njit(cache=True)
def _joint_force(joint: Any, deformation: float, rate: float, time: float, memory: np.ndarray) -> float:
    """The whole force of a joint; memory holds d_max, the branch's force, the fading force and the last static force."""
    d = deformation - joint.gap
    if joint.gap_softness > 0.0:
        d = joint.gap_softness * math.log1p(math.exp(min(d / joint.gap_softness, 500.0)))
    memory[0] = max(memory[0], d)
    force = _static_force(joint, d, memory[0])
    if memory[0] > joint.fracture_deformation:
        force *= 1.0 - joint.fracture_loss * min(1.0, (memory[0] - joint.fracture_deformation) / joint.fracture_width)
    touching = d > 0.0
    pulls = joint.tension_stiffness > 0.0
    memory[1] += STEP * ((joint.branch_stiffness * rate if touching else 0.0) - memory[1] / joint.branch_time)
    memory[2] += joint.fading_share * (force - memory[3]) - STEP * memory[2] / joint.fading_time
    memory[3] = force
    force = force * _rate_factor(joint, rate) + memory[2]
    if touching:
        force += memory[1]
    if touching or joint.damping_always:
        force += joint.damping * rate + joint.damping_quadratic * rate * abs(rate)
    if not (pulls or joint.damping_always):
        force = max(force, 0.0)
    if joint.friction != 0.0 and (touching or joint.friction_always):
        force += joint.friction * math.tanh(rate / joint.friction_velocity)
    if joint.pulse_force != 0.0 and abs(time - joint.pulse_time) < joint.pulse_width:
        window = math.cos(0.5 * math.pi * (time - joint.pulse_time) / joint.pulse_width) ** 2
        force += joint.pulse_force * window * math.cos(2.0 * math.pi * joint.pulse_frequency * (time - joint.pulse_time))
    return force


@numba.njit(cache=True)
def _integrate(bodies: Any, joints: Any, speed: float, steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Leapfrog: the velocities are half a step ahead of the positions."""
    rows = (steps + STRIDE - 1) // STRIDE
    stored_position, stored_acceleration = np.empty((rows, len(bodies))), np.empty((rows, len(bodies)))
    stored_deformation, stored_force = np.empty((rows, len(joints))), np.empty((rows, len(joints)))
    position, velocity = bodies.position.copy(), speed * bodies.moving
    net, memory = np.zeros(len(bodies)), np.zeros((len(joints), 4))
    for step in range(steps):
        time, row = step * STEP, step // STRIDE
        for i in range(len(bodies)):
            net[i] = 0.0
            if bodies[i].friction != 0.0:
                net[i] = -bodies[i].friction * math.tanh(velocity[i] / bodies[i].friction_velocity)
        for j in range(len(joints)):
            joint = joints[j]
            front, back, side = joint.front, joint.back, joint.side
            deformation = joint.length - side * (position[back] - position[front])
            force = _joint_force(joint, deformation, -side * (velocity[back] - velocity[front]), time, memory[j])
            net[front] -= side * force
            net[back] += side * force
            if step % STRIDE == 0:
                stored_deformation[row, j], stored_force[row, j] = deformation, force
        for i in range(len(bodies)):
            acceleration = net[i] * bodies[i].mobility
            if step % STRIDE == 0:
                stored_position[row, i], stored_acceleration[row, i] = position[i], acceleration
            velocity[i] += acceleration * STEP * (0.5 if step == 0 else 1.0)
            position[i] += velocity[i] * STEP
    return stored_position, stored_acceleration, stored_deformation, stored_force
