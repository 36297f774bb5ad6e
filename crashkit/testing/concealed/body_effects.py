"""Secrets of a body or between two bodies, each in more than one form."""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise

from crashkit.testing.concealed.effect import Answer, Effect, Stage
from crashkit.testing.concealed.vehicle import Scene
from crashkit.testing.concealed.world import GROUND, WorldJoint

GRAVITY = 9.81


def missing_contact(stage: Stage) -> Effect | None:
    """Two bodies that the model does not join touch after a gap: a line, Hertz's power, or a crushing plateau."""
    pair = _unjoined_pair(stage)
    if pair is None:
        return None
    front, back, approach = pair
    force, form = stage.field(stage.joint(), "crush_force"), stage.one_of(("line", "hertz", "crush"))
    gap = approach * stage.rng.uniform(0.4, 0.8)
    depth = approach - gap
    fields = {"gap": gap}
    if form == "hertz":
        fields |= {"bottom_force": force, "bottom_deformation": 0.0, "bottom_reference": depth, "bottom_power": 1.5}
    else:
        fields["elastic_stiffness"] = force / depth
    if form == "crush":
        fields |= {"crush_force": 0.5 * force, "unloading_stiffness": 4.0 * force / depth}

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        scene.world.joints["hidden_contact"] = WorldJoint(front, back, dict(numbers))

    scaled = ("elastic_stiffness", "crush_force", "bottom_force", "unloading_stiffness")
    return Effect("missing_contact", form, "bodies", [front, back], fields, change, scaled, (0.02, 10.0))


def _unjoined_pair(stage: Stage) -> tuple[str, str, float] | None:
    """Neighbours, or the obstacle and any body, without a joint; and how near they come in the fastest calibration run, m."""
    scene, trace = stage.scene, stage.traces[2]
    joined = {frozenset((joint.front, joint.back)) for joint in scene.world.joints.values()}
    pairs = []
    for front, back in [*pairwise(scene.bodies), *((scene.obstacle, body) for body in scene.bodies)]:
        distance = trace.position[front] - trace.position[back]
        approach = float(distance[0] - distance.min())
        if frozenset((front, back)) not in joined and approach > 0.03:
            pairs.append((front, back, approach))
    return pairs[stage.rng.integers(len(pairs))] if pairs else None


def ground_friction(stage: Stage) -> Effect:
    """The ground brakes a body, sharply or smoothly about rest."""
    body, form = stage.one_of(stage.scene.bodies), stage.one_of(("sharp", "smooth"))
    friction = stage.rng.uniform(0.3, 0.8) * GRAVITY * stage.scene.mass(body)
    fields = {"friction": friction, "friction_velocity": 0.02 if form == "sharp" else stage.rng.uniform(0.5, 1.5)}

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        scene.world.bodies[body].update(numbers)

    rivals: tuple[Answer, ...] = ()
    if "wall" not in stage.scene.instruments:  # then a joint to the obstacle could brake the body just as well
        joints = [name for name in stage.scene.public_joints if stage.scene.world.joints[name].back == body]
        rivals = tuple(("joint_friction", "joint", name) for name in joints if not stage.is_mount(name))
    return Effect("ground_friction", form, "body", body, fields, change, ("friction",), (0.05, 5.0), rivals)


def added_mass(stage: Stage) -> Effect | None:
    """A body is heavier or lighter than the model says; only a measured force can tell, and only with several bodies which."""
    if "wall" not in stage.scene.instruments or len(stage.scene.bodies) < 2:
        return None
    body, form = stage.one_of(stage.scene.bodies), stage.one_of(("heavier", "lighter"))
    fields = {"relative_mass": 0.15 if form == "heavier" else -0.15}

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        scene.world.bodies[body]["mobility"] /= 1.0 + numbers["relative_mass"]

    return Effect("added_mass", form, "body", body, fields, change, ("relative_mass",), (0.15, 3.0))


def carried_load(stage: Stage) -> Effect:
    """A mass of its own in a body: tied by spring and damper, with slack or without, or by a belt that yields."""
    body, form = stage.one_of(stage.scene.bodies), stage.one_of(("slack", "bound", "belt"))
    mass = stage.scene.mass(body) * stage.rng.uniform(0.08, 0.25)
    pulsation = 2.0 * math.pi * stage.rng.uniform(4.0, 15.0)
    fields = {
        "mass": mass,
        "elastic_stiffness": mass * pulsation**2,
        "damping": 2.0 * mass * pulsation * stage.rng.uniform(0.05, 0.4),
        "gap": 0.0 if form == "bound" else stage.rng.uniform(0.01, 0.06),
    }
    if form == "belt":
        fields |= {
            "crush_force": mass * stage.rng.uniform(100.0, 250.0),
            "unloading_stiffness": 4.0 * fields["elastic_stiffness"],
        }

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        ties = {name: value for name, value in numbers.items() if name != "mass"}
        position = scene.world.bodies[body]["position"]
        scene.world.bodies["hidden_load"] = {"position": position, "mobility": 1.0 / numbers["mass"]}
        scene.world.joints["hidden_tie"] = WorldJoint("hidden_load", body, ties)
        scene.world.joints["hidden_seat"] = WorldJoint(body, "hidden_load", ties)

    scaled = ("mass", "elastic_stiffness", "damping", "crush_force", "unloading_stiffness")
    return Effect("carried_load", form, "body", body, fields, change, scaled, (0.05, 3.0))


def obstacle_motion(stage: Stage) -> Effect:
    """The obstacle has a finite mass: on a spring and a damper, or sliding with friction."""
    obstacle, form = stage.scene.obstacle, stage.one_of(("spring", "sliding"))
    mass = sum(stage.scene.mass(body) for body in stage.scene.bodies) * stage.rng.uniform(10.0, 30.0)
    fields = {"mobility": 1.0 / mass}
    if form == "spring":
        pulsation = 2.0 * math.pi * stage.rng.uniform(3.0, 12.0)
        fields |= {"tie_stiffness": mass * pulsation**2, "tie_damping": 2.0 * mass * pulsation * stage.rng.uniform(0.02, 0.2)}
    else:
        fields |= {"friction": stage.rng.uniform(0.02, 0.2) * GRAVITY * mass, "friction_velocity": 0.01}

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        numbers = dict(numbers)
        stiffness, damping = numbers.pop("tie_stiffness", 0.0), numbers.pop("tie_damping", 0.0)
        scene.world.bodies[obstacle].update(numbers)
        scene.world.bodies[GROUND] = {"position": 0.0, "moving": 0.0}
        tie = {"elastic_stiffness": stiffness, "tension_stiffness": stiffness, "damping": damping, "damping_always": 1.0}
        scene.world.joints["hidden_ground"] = WorldJoint(GROUND, obstacle, tie)

    return Effect("obstacle_motion", form, "body", obstacle, fields, change, ("mobility",), (0.02, 5.0))


BODY_EFFECTS: dict[str, Callable[[Stage], Effect | None]] = {
    effect.__name__: effect for effect in (missing_contact, ground_friction, added_mass, carried_load, obstacle_motion)
}
