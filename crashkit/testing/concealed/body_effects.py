"""Secrets of a body, or between two bodies, each in several forms."""

import math
from itertools import combinations

from crashkit.testing.concealed.effect import Answer, Effect, Maker, Stage
from crashkit.testing.concealed.kinds import Kind
from crashkit.testing.concealed.scene import Scene
from crashkit.testing.concealed.world import Body, Joint, Term

GRAVITY = 9.81
GROUND = "ground"
"""What never moves and no instrument sees, ahead of everything."""


def missing_contact(stage: Stage) -> Effect | None:
    """Two bodies that the model does not join touch after a gap: a line, Hertz's power, an exponential foam, a crushed one."""
    pairs = _unjoined(stage)
    if not pairs:
        return None
    front, back, approach = pairs[int(stage.rng.integers(len(pairs)))]
    form, gap = stage.form("line", "hertz", "foam", "crush"), approach * stage.among(0.4, 0.8)
    force, rest = stage.true(stage.joint()).level(), approach - gap
    kind, numbers = {
        "line": (Kind.STOP_LINE, (force / rest, 0.0)),
        "hertz": (Kind.STOP_HERTZ, (force, 0.0, rest)),
        "foam": (Kind.STOP_EXPONENTIAL, (0.3 * force, 0.0, 0.5 * rest)),
        "crush": (Kind.STOP_LINE, (force / rest, 0.0)),
    }[form]

    def conceal(scene: Scene, strength: float) -> None:
        terms = [Term(Kind.GAP, (gap,)), Term(kind, (numbers[0] * strength, *numbers[1:]))]
        if form == "crush":
            terms.append(Term(Kind.UNLOAD_LINE, (1.0, 5.0 * strength * force / rest)))
        scene.world.joints["hidden_contact"] = Joint(front, back, terms=terms, one_way=True)

    return Effect("missing_contact", form, "bodies", [front, back], {"gap": gap, "numbers": numbers}, conceal, (0.02, 10.0))


def _unjoined(stage: Stage) -> list[tuple[str, str, float]]:
    """Pairs without a joint that come nearer in the fastest run that is fitted, and by how much, m."""
    scene, motion = stage.scene, stage.motions[-1]
    joined = {frozenset((joint.front, joint.back)) for joint in scene.world.joints.values()}
    pairs = []
    for front, back in combinations([scene.obstacle, *scene.bodies], 2):
        distance = abs(motion.position[front] - motion.position[back])
        approach = float(distance[0] - distance.min())
        if frozenset((front, back)) not in joined and 0.05 * distance[0] < approach < 0.95 * distance[0]:
            pairs.append((front, back, approach))
    return pairs


def ground_friction(stage: Stage) -> Effect:
    """The ground brakes a body: sharp about rest, smooth, faster is less, or only after some way."""
    body, form = stage.one_of(*stage.scene.bodies), stage.form("sharp", "smooth", "stribeck", "later")
    speed, force = stage.scene.speeds[-2], 0.5 * GRAVITY * stage.scene.world.bodies[body].mass
    way = 0.2 * speed * stage.scene.duration
    kind, numbers = {
        "sharp": (Kind.FRICTION, (force, 0.01, 1.0)),
        "smooth": (Kind.FRICTION, (force, speed * stage.among(0.02, 0.1), 1.0)),
        "stribeck": (Kind.FRICTION_STRIBECK, (force, 0.02, 1.0, speed * stage.among(0.1, 0.3))),
        "later": (Kind.FRICTION_LATER, (force, 0.02, way * stage.among(0.1, 0.3))),
    }[form]

    def conceal(scene: Scene, strength: float) -> None:
        _add_ground(scene)
        scene.world.joints["hidden_brake"] = Joint(GROUND, body, terms=[Term(kind, (numbers[0] * strength, *numbers[1:]))])

    rivals: tuple[Answer, ...] = ()
    if "load_cell" not in stage.scene.instruments:  # then a joint to the obstacle could brake the body just as well
        joints = stage.scene.world.joints.items()
        rivals = tuple(
            ("joint_friction", "joint", name)
            for name, joint in joints
            if joint.back == body and joint.front == stage.scene.obstacle
        )
    return Effect("ground_friction", form, "body", body, {"numbers": numbers}, conceal, (0.03, 10.0), rivals)


def added_mass(stage: Stage) -> Effect | None:
    """A body is heavier or lighter than the model says; only a measured force can tell, and only with several bodies which."""
    if "load_cell" not in stage.scene.instruments or len(stage.scene.bodies) < 2:
        return None
    body, form = stage.one_of(*stage.scene.bodies), stage.form("heavier", "lighter")
    share = 0.15 if form == "heavier" else -0.15

    def conceal(scene: Scene, strength: float) -> None:
        scene.world.bodies[body].mass *= 1.0 + share * strength

    return Effect("added_mass", form, "body", body, {"share": share}, conceal, (0.1, 4.0))


def carried_load(stage: Stage) -> Effect:
    """A mass of its own in a body: bound, with slack, held by a belt that yields, or sliding until it hits."""
    body, form = stage.one_of(*stage.scene.bodies), stage.form("bound", "slack", "belt", "sliding")
    mass = stage.scene.world.bodies[body].mass * stage.among(0.1, 0.3)
    pulsation = 2.0 * math.pi * stage.among(0.6, 2.0) / stage.scene.duration
    deceleration = stage.scene.speeds[-2] / (0.5 * stage.scene.duration)
    travel = 0.5 * deceleration / pulsation**2
    slack = 0.0 if form == "bound" else travel * stage.among(0.2, 0.8)
    limit = mass * deceleration * stage.among(0.5, 1.0) if form == "belt" else math.inf
    damping = 2.0 * pulsation * stage.among(0.05, 0.4)

    def conceal(scene: Scene, strength: float) -> None:
        weight = mass * strength
        terms = [Term(Kind.TIE, (weight * pulsation**2, weight * damping, slack, limit * strength))]
        if form == "sliding":
            terms.append(Term(Kind.FRICTION, (0.05 * weight * deceleration, 0.02, 1.0)))
        scene.world.bodies["load"] = Body(scene.world.bodies[body].position, weight)
        scene.world.joints["hidden_tie"] = Joint(body, "load", terms=terms)

    numbers = {"mass": mass, "frequency": pulsation / 2.0 / math.pi, "slack": slack, "limit": limit}
    return Effect("carried_load", form, "body", body, numbers, conceal, (0.03, 4.0))


def obstacle_motion(stage: Stage) -> Effect:
    """The obstacle has a finite mass: on a spring, sliding on its base, or crushing what is behind it."""
    scene, form = stage.scene, stage.form("spring", "sliding", "crushing")
    mass = sum(scene.world.bodies[body].mass for body in scene.bodies) * stage.among(5.0, 20.0)
    pulsation = 2.0 * math.pi * stage.among(0.3, 1.5) / scene.duration
    deceleration = scene.speeds[-2] / (0.5 * scene.duration)
    carried = stage.among(0.1, 0.5) * mass * deceleration / 10.0

    def conceal(scene: Scene, strength: float) -> None:
        weight, stiffness = mass / strength, mass / strength * pulsation**2
        terms = [Term(Kind.STOP_LINE, (stiffness, 0.0)), Term(Kind.UNLOAD_LINE, (1.0, 20.0 * stiffness))]
        if form == "spring":
            terms = [Term(Kind.TIE, (stiffness, 0.1 * weight * pulsation, 0.0, math.inf))]
        elif form == "sliding":
            terms = [Term(Kind.FRICTION, (carried, 0.005, 1.0))]
        _add_ground(scene)
        scene.world.bodies[scene.obstacle].mass = weight
        scene.world.joints["hidden_base"] = Joint(GROUND, scene.obstacle, terms=terms)

    numbers = {"mass": mass, "frequency": pulsation / 2.0 / math.pi, "sliding_force": carried}
    return Effect("obstacle_motion", form, "body", scene.obstacle, numbers, conceal, (0.01, 5.0))


def rotation(stage: Stage) -> Effect | None:
    """A body pitches: every sensor on it, at its own height, takes part; soon at rest again, or swinging on."""
    body, form = stage.one_of(*stage.scene.bodies), stage.form("damped", "swinging")
    frequency = stage.among(0.8, 3.0) / stage.scene.duration
    damping = stage.among(0.3, 0.7) if form == "damped" else stage.among(0.02, 0.15)
    sensors = [
        (group, name) for group, one in stage.scene.instruments.items() for name, s in one.sensors.items() if s.body == body
    ]
    if len({group for group, _ in sensors}) < 2:
        return None  # what a single instrument shows could be its own fault
    levers = {sensor: stage.among(0.05, 0.3) * stage.rng.choice([-1.0, 1.0]) for sensor in sensors}

    def conceal(scene: Scene, strength: float) -> None:
        for (group, name), lever in levers.items():
            scene.instruments[group].sensors[name].pitch = (strength * lever, frequency, damping)

    return Effect("rotation", form, "body", body, {"frequency": frequency, "damping": damping}, conceal)


def _add_ground(scene: Scene) -> None:
    scene.world.bodies[GROUND] = Body(1.0, moves=False)


BODY_EFFECTS: dict[str, Maker] = {
    maker.__name__: maker for maker in (missing_contact, ground_friction, added_mass, carried_load, obstacle_motion, rotation)
}
