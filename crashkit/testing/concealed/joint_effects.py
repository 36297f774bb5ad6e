"""Secrets of a joint, each in several functional forms."""

import math

from attrs import evolve

from crashkit.testing.concealed.effect import Effect, Maker, Stage, one_term
from crashkit.testing.concealed.kinds import Kind
from crashkit.testing.concealed.scene import Scene
from crashkit.testing.concealed.world import Term


def rate_dependence(stage: Stage) -> Effect:
    """The force level rises with the rate: in proportion, as a power, as Eyring's inverse sine, or up to a limit."""
    joint, form = stage.joint(), stage.form("linear", "power", "eyring", "saturating")
    kind, numbers = {
        "linear": (Kind.RATE_LINEAR, (0.03,)),
        "power": (Kind.RATE_POWER, (0.3, 10.0, stage.among(0.15, 0.7))),
        "eyring": (Kind.RATE_EYRING, (0.08, stage.among(0.05, 1.0))),
        "saturating": (Kind.RATE_SATURATING, (0.4, stage.among(0.2, 0.6) * stage.fastest(joint))),
    }[form]
    return one_term("rate_dependence", form, joint, kind, numbers)


def viscous_damping(stage: Stage) -> Effect:
    """A damper beside the spring: linear, an orifice, a seal; while they touch, or for a mount always."""
    joint, form = stage.joint(), stage.form("linear", "orifice", "seal")
    power = {"linear": 1.0, "orifice": stage.among(1.6, 2.0), "seal": stage.among(0.6, 0.8)}[form]
    always = stage.is_mount(joint) and stage.rng.random() < 0.5
    coefficient = 0.3 * stage.true(joint).level() / max(stage.fastest(joint), 0.5) ** power
    return one_term("viscous_damping", form, joint, Kind.DAMP_ALWAYS if always else Kind.DAMP_TOUCHING, (coefficient, power))


def plastic_unloading(stage: Stage) -> Effect:
    """The model's joint is elastic, a share of the true one unloads along a line, an exponential, or two lines."""
    joint, form = stage.joint(), stage.form("line", "fading", "two_lines")
    spring = stage.true(joint)
    stiffness = spring.parameters.pop("unloading_stiffness")  # what the model believes
    kind, numbers = {
        "line": (Kind.UNLOAD_LINE, (1.0, stiffness)),
        "fading": (Kind.UNLOAD_FADE, (1.0, spring.level() / stiffness)),
        "two_lines": (Kind.UNLOAD_TWO, (1.0, stiffness, stiffness * stage.among(0.2, 0.5))),
    }[form]
    return one_term("plastic_unloading", form, joint, kind, numbers, (1.0 if stage.plain else 0.02, 1.0))


def clearance(stage: Stage) -> Effect:
    """The joint engages after a gap, at once or over a toe."""
    joint, form = stage.joint(), stage.form("gap", "toe")
    gap = stage.among(0.1, 0.4) * stage.deepest(joint)
    toe = stage.among(0.1, 0.4) * gap
    if form == "gap":
        return one_term("clearance", form, joint, Kind.GAP, (gap,), (0.03, 2.0))
    return one_term("clearance", form, joint, Kind.TOE, (gap, toe), (0.03, 2.0))


def peak_load(stage: Stage) -> Effect:
    """An undeformed member buckles: a peak where the plateau begins, with a point, a bell, or one that dies slowly."""
    joint, form = stage.joint(), stage.form("triangle", "bump", "bell")
    force, peak = 0.6 * stage.true(joint).level(), stage.true(joint).elastic_limit() * stage.among(0.85, 1.15)
    width = peak * stage.among(0.25, 0.7)
    kind, numbers = {
        "triangle": (Kind.PEAK_TRIANGLE, (force, peak, width)),
        "bump": (Kind.PEAK_BUMP, (force, peak)),
        "bell": (Kind.PEAK_BELL, (force, peak, width)),
    }[form]
    return one_term("peak_load", form, joint, kind, numbers)


def progressive_folding(stage: Stage) -> Effect:
    """The plateau oscillates: a sine, a saw, arches, or folds that get shorter."""
    joint, form = stage.joint(), stage.form("sine", "saw", "arches", "shortening")
    start = stage.true(joint).elastic_limit()
    length = max(stage.deepest(joint) - start, 0.05 * start) / stage.among(2.0, 6.0)
    kind = {
        "sine": Kind.FOLD_SINE,
        "saw": Kind.FOLD_SAW,
        "arches": Kind.FOLD_ARCHES,
        "shortening": Kind.FOLD_CHIRP,
    }[form]
    numbers = (0.25 * stage.true(joint).level(), length, start, 0.08)
    return one_term("progressive_folding", form, joint, kind, numbers, (0.02, 3.0))


def bottoming(stage: Stage) -> Effect | None:
    """The joint stiffens beyond a deformation that the faster runs reach: a line, a parabola, a pole or an exponential."""
    joint, form = stage.joint(), stage.form("line", "parabola", "pole", "exponential")
    deepest, force = stage.deepest(joint), 2.0 * stage.true(joint).level()
    if deepest <= 0.0:
        return None  # a mount that only ever pulls
    start = deepest * stage.among(0.55, 0.85)
    rest = deepest - start
    kind, numbers = {
        "line": (Kind.STOP_LINE, (force / rest, start)),
        "parabola": (Kind.STOP_PARABOLA, (force, start, rest)),
        "pole": (Kind.STOP_POLE, (0.5 * force, start, 1.5 * rest)),
        "exponential": (Kind.STOP_EXPONENTIAL, (0.2 * force, start, 0.5 * rest)),
    }[form]
    return one_term("bottoming", form, joint, kind, numbers, (0.01, 10.0))


def fracture(stage: Stage) -> Effect:
    """Part of the force is lost for good: at once, over a stretch, or in two steps."""
    joint, form = stage.joint(), stage.form("sudden", "ramp", "twice")
    kind = {"sudden": Kind.BREAK_SUDDEN, "ramp": Kind.BREAK_RAMP, "twice": Kind.BREAK_TWICE}[form]
    deepest = stage.deepest(joint)
    numbers = (0.5, deepest * stage.among(0.3, 0.8), deepest * stage.among(0.08, 0.2))
    return one_term("fracture", form, joint, kind, numbers, (0.05, 2.0))


def tension(stage: Stage) -> Effect:
    """The joint also pulls: its own line goes on below zero, or a strap, with slack or up to a limit."""
    joint, form = stage.joint(), stage.form("law", "strap", "slack_strap", "limited_strap")
    spring = stage.true(joint)
    if form == "law":
        return one_term("tension", form, joint, Kind.PULL_LAW, (1.0,), (0.002, 1.0))
    slack = 0.3 * spring.elastic_limit() if form == "slack_strap" else 0.0
    limit = 0.3 * spring.level() if form == "limited_strap" else math.inf
    stiffness = 0.5 * spring.level() / spring.elastic_limit()
    return one_term("tension", form, joint, Kind.PULL_STRAP, (stiffness, slack, limit))


def relaxation(stage: Stage) -> Effect:
    """Part of the force fades: a Maxwell branch, two of them, or the fresh part of the spring's own force."""
    joint, form = stage.joint(), stage.form("maxwell", "two_branches", "fresh_part")
    spring, times = stage.true(joint), sorted(stage.scene.duration * stage.among(0.03, 0.3) for _ in range(2))
    stiffness = 0.3 * spring.level() / spring.elastic_limit()
    if form == "fresh_part":
        return one_term("relaxation", form, joint, Kind.LAG, (0.5, times[0]))
    if form == "maxwell":
        return one_term("relaxation", form, joint, Kind.MAXWELL, (stiffness, times[0]))

    def conceal(scene: Scene, strength: float) -> None:
        branches = [
            Term(Kind.MAXWELL, (stiffness * share * strength, time)) for share, time in zip((0.7, 0.3), times, strict=True)
        ]
        scene.world.joints[joint].terms.extend(branches)

    return Effect("relaxation", form, "joint", joint, {"stiffness": stiffness, "times": times}, conceal)


def joint_friction(stage: Stage) -> Effect:
    """Dry friction, sharp or smooth about rest, falling with the rate, or in bristles; a mount's acts always."""
    joint, form = stage.joint(), stage.form("sharp", "smooth", "stribeck", "bristle")
    force, always = 0.2 * stage.true(joint).level(), float(stage.is_mount(joint))
    fastest = stage.fastest(joint)
    kind, numbers = {
        "sharp": (Kind.FRICTION, (force, 0.01, always)),
        "smooth": (Kind.FRICTION, (force, fastest * stage.among(0.02, 0.08), always)),
        "stribeck": (Kind.FRICTION_STRIBECK, (force, 0.02, always, fastest * stage.among(0.1, 0.3))),
        "bristle": (Kind.FRICTION_BRISTLE, (force, stage.deepest(joint) * stage.among(0.005, 0.03), always)),
    }[form]
    return _or_on_body(stage, one_term("joint_friction", form, joint, kind, numbers), "ground_friction")


def unknown(stage: Stage) -> Effect:
    """What no list has: a dent in the plateau, a timed pulse, a hum, a window of rates, a force that work softens or that
    another joint drives."""
    joint = stage.joint()
    drivers = _elsewhere(stage, joint)
    form = stage.form("dent", "pulse", "hum", "rate_window", "softening", *(["stiffened", "weakened"] if drivers else []))
    if form in ("stiffened", "weakened"):
        return _driven(stage, form, joint, stage.one_of(*drivers))
    force, deepest, fastest = stage.true(joint).level(), stage.deepest(joint), stage.fastest(joint)
    duration = stage.scene.duration
    width = duration * stage.among(0.06, 0.12)
    kind, numbers = {
        "dent": (Kind.DENT, (0.4 * force, deepest * stage.among(0.4, 0.7), deepest * stage.among(0.1, 0.2))),
        "pulse": (Kind.PULSE, (0.4 * force, width + duration * stage.among(0.02, 0.2), width)),
        "hum": (Kind.HUM, (0.3 * force, stage.among(5.0, 12.0) / duration, duration * stage.among(0.2, 0.6))),
        "rate_window": (Kind.RATE_WINDOW, (-0.4, fastest * stage.among(0.4, 0.7), fastest * stage.among(0.15, 0.25))),
        "softening": (Kind.SOFTENING, (0.5, force * deepest * stage.among(0.3, 0.8))),
    }[form]
    effect = one_term("unknown", form, joint, kind, numbers, (0.02, 2.0))
    rivals = {"rate_window": "rate_dependence", "softening": "fracture"}
    if form in rivals:
        return evolve(effect, rivals=((rivals[form], "joint", joint),))
    return _or_on_body(stage, effect, "unknown") if form in ("pulse", "hum") else effect


def _elsewhere(stage: Stage, joint: str) -> list[str]:
    """The joints that are used and do not join the same two bodies."""
    ends = {name: {stage.true(name).front, stage.true(name).back} for name in stage.scene.public}
    return [name for name, pair in ends.items() if pair != ends[joint] and stage.deepest(name) > 0.0]


def _driven(stage: Stage, form: str, joint: str, driver: str) -> Effect:
    """The force rises or falls with the deformation of another joint, as far as a part of what that reaches."""
    size, reach = 0.4 if form == "stiffened" else -0.4, stage.among(0.3, 1.0) * stage.deepest(driver)

    def conceal(scene: Scene, strength: float) -> None:
        scene.world.joints[joint].terms.append(Term(Kind.DRIVEN, (size * strength, reach), driver))

    return Effect("unknown", form, "joint", joint, {"driver": driver, "driven": [size, reach]}, conceal, (0.02, 2.0))


def _or_on_body(stage: Stage, effect: Effect, physics: str) -> Effect:
    """A force between the obstacle and a body is a force on the body, unless the obstacle's side of it is measured."""
    if stage.is_mount(effect.place) or "load_cell" in stage.scene.instruments:
        return effect
    return evolve(effect, rivals=((physics, "body", stage.true(effect.place).back),))


JOINT_EFFECTS: dict[str, Maker] = {
    maker.__name__: maker
    for maker in (
        rate_dependence,
        viscous_damping,
        plastic_unloading,
        clearance,
        peak_load,
        progressive_folding,
        bottoming,
        fracture,
        tension,
        relaxation,
        joint_friction,
        unknown,
    )
}
