"""Secrets of a joint, each in more than one functional form."""

from collections.abc import Callable, Mapping

from attrs import evolve

from crashkit.testing.concealed.effect import Answer, Effect, Stage
from crashkit.testing.concealed.vehicle import Scene


def _in_joint(
    physics: str,
    form: str,
    joint: str,
    fields: Mapping[str, float],
    scaled: str | tuple[str, ...],
    limits: tuple[float, float] = (0.02, 4.0),
) -> Effect:
    scaled = (scaled,) if isinstance(scaled, str) else scaled

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        scene.world.joints[joint].fields.update(numbers)

    return Effect(physics, form, "joint", joint, fields, change, scaled, limits)


def rate_dependence(stage: Stage) -> Effect:
    """The force level rises with the rate: in proportion, as a power (Cowper-Symonds) or as a logarithm (Johnson-Cook)."""
    joint, form = stage.joint(), stage.one_of(("linear", "power", "logarithm"))
    if form == "linear":
        return _in_joint("rate_dependence", form, joint, {"rate_linear": 0.02}, "rate_linear")
    if form == "power":
        fields = {"rate_power_size": 0.3, "rate_power": stage.rng.uniform(0.15, 0.6)}
        return _in_joint("rate_dependence", form, joint, fields, "rate_power_size")
    fields = {"rate_log_size": 0.1, "rate_log_reference": stage.rng.uniform(0.1, 2.0)}
    return _in_joint("rate_dependence", form, joint, fields, "rate_log_size")


def viscous_damping(stage: Stage) -> Effect:
    """A damper beside the spring: linear or quadratic while they touch, or a strut that also pulls."""
    joint = stage.joint()
    form = stage.one_of(("linear", "quadratic", "strut") if stage.is_mount(joint) else ("linear", "quadratic"))
    force, rate = 0.3 * stage.field(joint, "crush_force"), max(stage.fastest(joint), 1.0)
    if form == "quadratic":
        return _in_joint("viscous_damping", form, joint, {"damping_quadratic": force / rate**2}, "damping_quadratic")
    fields = {"damping": force / rate, "damping_always": float(form == "strut")}
    return _in_joint("viscous_damping", form, joint, fields, "damping")


def plastic_unloading(stage: Stage) -> Effect:
    """The model's joint is elastic, the true one (or a part of it) unloads along a steep line or a curve."""
    joint, form = stage.joint(), stage.one_of(("line", "curve"))
    stiffness = stage.field(joint, "elastic_stiffness") * stage.rng.uniform(2.0, 8.0)
    stage.scene.world.joints[joint].fields.pop("unloading_stiffness", None)  # what the model believes
    power = 1.0 if form == "line" else stage.rng.uniform(1.5, 3.0)
    fields = {"unloading_stiffness": stiffness, "unloading_power": power, "plastic_share": 1.0}
    return _in_joint("plastic_unloading", form, joint, fields, "plastic_share", (0.6, 1.0))


def clearance(stage: Stage) -> Effect:
    """The joint engages after a gap, sharply or softly."""
    joint, form = stage.joint(), stage.one_of(("sharp", "soft"))
    gap = stage.rng.uniform(0.1, 0.4) * stage.deepest(joint)
    fields = {"gap": gap, "gap_softness": gap * stage.rng.uniform(0.1, 0.25) * (form == "soft")}
    return _in_joint("clearance", form, joint, fields, ("gap", "gap_softness"), (0.05, 2.0))


def peak_load(stage: Stage) -> Effect:
    """An undeformed member buckles: a peak where the plateau begins, with a point or rounded."""
    joint, form = stage.joint(), stage.one_of(("triangle", "round"))
    fields = {
        "peak_force": 0.5 * stage.field(joint, "crush_force"),
        "peak_deformation": stage.elastic_limit(joint) * stage.rng.uniform(0.9, 1.2),
        "peak_width": stage.elastic_limit(joint) * stage.rng.uniform(0.3, 0.8),
        "peak_round": float(form == "round"),
    }
    return _in_joint("peak_load", form, joint, fields, "peak_force")


def progressive_folding(stage: Stage) -> Effect:
    """The plateau oscillates: a sine, a zigzag, or folds that die away."""
    joint, form = stage.joint(), stage.one_of(("sine", "zigzag", "fading"))
    span = max(stage.deepest(joint) - stage.elastic_limit(joint), 0.01)
    fields = {
        "fold_force": 0.25 * stage.field(joint, "crush_force"),
        "fold_length": span / stage.rng.uniform(2.0, 6.0),
        "fold_start": stage.elastic_limit(joint),
        "fold_sharp": float(form == "zigzag"),
    }
    if form == "fading":
        fields["fold_decay"] = span * stage.rng.uniform(0.4, 1.0)
    return _in_joint("progressive_folding", form, joint, fields, "fold_force", (0.02, 3.0))


def bottoming(stage: Stage) -> Effect:
    """The joint stiffens beyond a deformation that the faster runs reach: a line, a parabola or a steep power."""
    joint, form = stage.joint(), stage.one_of(("line", "parabola", "power"))
    deepest = stage.deepest(joint)
    start = deepest * stage.rng.uniform(0.5, 0.85)
    power = {"line": 1.0, "parabola": 2.0, "power": stage.rng.uniform(3.0, 5.0)}[form]
    fields = {
        "bottom_force": 2.0 * stage.field(joint, "crush_force"),
        "bottom_deformation": start,
        "bottom_reference": deepest - start,
        "bottom_power": power,
    }
    return _in_joint("bottoming", form, joint, fields, "bottom_force", (0.02, 10.0))


def fracture(stage: Stage) -> Effect:
    """Part of the force is lost for good, at once or over a stretch."""
    joint, form = stage.joint(), stage.one_of(("sudden", "gradual"))
    fields = {
        "fracture_loss": 0.5,
        "fracture_deformation": stage.deepest(joint) * stage.rng.uniform(0.3, 0.8),
        "fracture_width": 1e-3 if form == "sudden" else stage.deepest(joint) * stage.rng.uniform(0.1, 0.3),
    }
    return _in_joint("fracture", form, joint, fields, "fracture_loss", (0.1, 2.0))


def tension(stage: Stage) -> Effect:
    """The joint also pulls: like a spring, or up to a limit."""
    joint, form = stage.joint(), stage.one_of(("spring", "limited"))
    stiffness = stage.field(joint, "elastic_stiffness")
    if form == "spring":
        return _in_joint("tension", form, joint, {"tension_stiffness": 0.5 * stiffness}, "tension_stiffness")
    fields = {"tension_stiffness": stiffness, "tension_limit": 0.3 * stage.field(joint, "crush_force")}
    return _in_joint("tension", form, joint, fields, "tension_limit")


def relaxation(stage: Stage) -> Effect:
    """Part of the force fades: a Maxwell branch beside the spring, or a fading share of the spring's own force."""
    joint, form = stage.joint(), stage.one_of(("maxwell", "fading_share"))
    time = stage.rng.uniform(0.003, 0.03)
    if form == "maxwell":
        fields = {"branch_stiffness": 0.3 * stage.field(joint, "elastic_stiffness"), "branch_time": time}
        return _in_joint("relaxation", form, joint, fields, "branch_stiffness")
    return _in_joint("relaxation", form, joint, {"fading_share": 0.4, "fading_time": time}, "fading_share")


def joint_friction(stage: Stage) -> Effect:
    """Dry friction in the joint, sharp or smooth about rest; in a mount always, elsewhere while it touches."""
    joint, form = stage.joint(), stage.one_of(("sharp", "smooth"))
    fields = {
        "friction": 0.15 * stage.field(joint, "crush_force"),
        "friction_velocity": 0.02 if form == "sharp" else stage.rng.uniform(0.2, 0.8),
        "friction_always": float(stage.is_mount(joint)),
    }
    return _or_on_body(stage, _in_joint("joint_friction", form, joint, fields, "friction"), "ground_friction")


def unknown(stage: Stage) -> Effect:
    """What no list has: a dent in the plateau, a force that knows the time, a force level that rises and falls with rate."""
    joint, form = stage.joint(), stage.one_of(("dent", "timed_pulse", "timed_hum", "rate_hump"))
    force, deepest = stage.field(joint, "crush_force"), stage.deepest(joint)
    if form == "dent":
        place = {
            "peak_deformation": deepest * stage.rng.uniform(0.4, 0.7),
            "peak_width": deepest * stage.rng.uniform(0.06, 0.15),
        }
        return _in_joint(
            "unknown", form, joint, {"peak_force": -0.4 * force, "peak_round": 1.0, **place}, "peak_force", (0.02, 2.4)
        )
    if form == "rate_hump":
        fields = {"rate_hump_size": 0.4, "rate_hump_reference": stage.rng.uniform(0.2, 0.35) * stage.fastest(joint)}
        effect = _in_joint("unknown", form, joint, fields, "rate_hump_size")
        return evolve(effect, rivals=(("rate_dependence", "joint", joint),))  # half of it is
    frequency = 0.0 if form == "timed_pulse" else stage.rng.uniform(60.0, 150.0)
    width = stage.rng.uniform(0.005, 0.015) * (1.0 if form == "timed_pulse" else 3.0)
    fields = {"pulse_force": 0.4 * force, "pulse_time": width + 0.01, "pulse_width": width, "pulse_frequency": frequency}
    return _or_on_body(stage, _in_joint("unknown", form, joint, fields, "pulse_force"), "unknown")


def _or_on_body(stage: Stage, effect: Effect, physics: str) -> Effect:
    """A force between the obstacle and a body is a force on the body, unless the obstacle's side of it is measured."""
    if stage.is_mount(effect.place) or "wall" in stage.scene.instruments:
        return effect
    answer: Answer = (physics, "body", stage.scene.world.joints[effect.place].back)
    return evolve(effect, rivals=(answer,))


JOINT_EFFECTS: dict[str, Callable[[Stage], Effect | None]] = {
    effect.__name__: effect
    for effect in (
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
