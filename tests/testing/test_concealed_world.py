"""The concealed world against closed-form mechanics, its own balances, and the engine that it shares nothing with."""

import ast
import math
from pathlib import Path

import numpy as np
import pytest
from attrs import evolve

from crashkit.misfit import Misfit
from crashkit.model.toml import read_model
from crashkit.registry import load
from crashkit.testing import concealed
from crashkit.testing.concealed.draft import EFFECTS
from crashkit.testing.concealed.effect import Stage
from crashkit.testing.concealed.given import model_text
from crashkit.testing.concealed.joint_effects import JOINT_EFFECTS
from crashkit.testing.concealed.kinds import Kind
from crashkit.testing.concealed.recording import record
from crashkit.testing.concealed.vehicle import draw_scene
from crashkit.testing.concealed.world import Body, Joint, Term, World, run

MASS, STIFFNESS, SPEED = 900.0, 1.1e6, 9.0
ELASTIC = {
    "elastic_stiffness": STIFFNESS,
    "crush_force": 1e9,
    "densification_deformation": 1e4,
    "densification_stiffness": 1.0,
}


def one_mass(*terms: Term, law: str = "crush_plateau", **numbers: float) -> World:
    bodies = {"wall": Body(0.0, moves=False), "cart": Body(-1.0, MASS)}
    return World(bodies, {"front": Joint("wall", "cart", law, ELASTIC | numbers if law else {}, list(terms))})


def rebound(world: World, duration: float = 0.2) -> float:
    """m s-1, at the end."""
    return float(run(world, SPEED, duration).velocity["cart"][-1])


def kinetic(world: World, motion, instant: int) -> float:
    return sum(
        0.5 * body.mass * motion.velocity[name][instant] ** 2
        for name, body in world.bodies.items()
        if math.isfinite(body.mass)
    )


def test_an_elastic_impact_is_half_a_sine():
    pulsation = math.sqrt(STIFFNESS / MASS)
    motion = run(one_mass(), SPEED, math.pi / pulsation)
    assert motion.position["cart"] + 1.0 == pytest.approx(SPEED / pulsation * np.sin(pulsation * motion.time), abs=1e-12)


def test_the_scheme_is_of_fourth_order():
    pulsation, error = math.sqrt(STIFFNESS / MASS), []
    for step in (2e-3, 1e-3):
        motion = run(one_mass(), SPEED, 0.04, step)
        error.append(abs(motion.position["cart"][-1] + 1.0 - SPEED / pulsation * math.sin(pulsation * motion.time[-1])))
    assert error[0] / error[1] == pytest.approx(16.0, rel=0.15)


def test_plastic_unloading_gives_back_what_its_line_encloses():
    force, unloading = 1.2e5, 5e6
    speed = rebound(one_mass(crush_force=force, unloading_stiffness=unloading))
    assert 0.5 * MASS * speed**2 == pytest.approx(force**2 / (2.0 * unloading), rel=1e-4)


def test_a_curve_of_corners_takes_up_the_work_below_it():
    numbers = {"deformation": [0.05, 0.2], "force": [1e5, 1.4e5], "final_stiffness": 2e5, "unloading_stiffness": 1e7}
    world = one_mass()
    world.joints["front"] = Joint("wall", "cart", "piecewise_affine", numbers)
    deepest = run(world, SPEED, 0.2).deformation["front"].max()
    over = deepest - 0.2
    assert over > 0.0
    work = 0.5 * 0.05 * 1e5 + 0.15 * 1.2e5 + over * (1.4e5 + 0.5 * 2e5 * over)
    assert work == pytest.approx(0.5 * MASS * SPEED**2, rel=1e-5)


def test_densification_follows_the_plateau():
    world = one_mass(crush_force=5e4, densification_deformation=0.2, densification_stiffness=4e5)
    motion = run(world, SPEED, 0.1)
    loading = slice(0, int(motion.deformation["front"].argmax()))
    deformation = motion.deformation["front"][loading]
    expected = np.minimum(STIFFNESS * deformation, 5e4) + 4e5 * np.maximum(deformation - 0.2, 0.0)
    assert motion.force["front"][loading] == pytest.approx(expected, abs=1e-6)


def test_a_linear_rate_factor_multiplies_the_static_force():
    motion = run(one_mass(Term(Kind.RATE_LINEAR, (0.03,))), SPEED, 0.03)
    expected = STIFFNESS * motion.deformation["front"] * (1.0 + 0.03 * motion.velocity["cart"])
    assert motion.force["front"] == pytest.approx(expected, rel=1e-9)


def test_a_break_loses_force_for_good():
    motion = run(one_mass(Term(Kind.BREAK_SUDDEN, (0.5, 0.1))), SPEED, 0.15)
    deformation, force = motion.deformation["front"], motion.force["front"]
    broken = int(np.argmax(deformation > 0.1))
    assert force[:broken] == pytest.approx(STIFFNESS * deformation[:broken], rel=1e-9)
    assert force[broken:] == pytest.approx(0.5 * STIFFNESS * np.maximum(deformation[broken:], 0.0), rel=1e-9)


def test_a_damper_alone_slows_down_exponentially():
    speed = rebound(one_mass(Term(Kind.DAMP_ALWAYS, (2e4, 1.0)), law=""))
    assert speed == pytest.approx(SPEED * math.exp(-2e4 / MASS * 0.2), rel=1e-9)


def test_an_orifice_alone_slows_down_as_one_over_time():
    speed = rebound(one_mass(Term(Kind.DAMP_ALWAYS, (2e3, 2.0)), law=""))
    assert speed == pytest.approx(SPEED / (1.0 + 2e3 * SPEED / MASS * 0.2), rel=1e-9)


def test_dry_friction_stops_after_the_known_way():
    motion = run(one_mass(Term(Kind.FRICTION, (5e4, 1e-3, 1.0)), law=""), SPEED, 0.3)
    assert motion.position["cart"][-1] + 1.0 == pytest.approx(MASS * SPEED**2 / (2.0 * 5e4), rel=1e-3)


def test_a_maxwell_branch_tends_to_its_viscosity():
    world = one_mass(Term(Kind.MAXWELL, (1e5, 0.004)), law="")
    world.bodies["cart"].mass = 1e12
    motion = run(world, SPEED, 0.03)
    expected = 1e5 * 0.004 * SPEED * (1.0 - np.exp(-motion.time / 0.004))
    assert motion.force["front"] == pytest.approx(expected, abs=2.0)


def test_a_bristle_holds_like_a_spring_and_slides_like_friction():
    world = one_mass(Term(Kind.FRICTION_BRISTLE, (1e3, 0.01, 1.0)), law="")
    world.bodies["cart"].mass = 1e12
    motion = run(world, SPEED, 0.02)
    assert motion.force["front"] == pytest.approx(1e3 * (1.0 - np.exp(-SPEED * motion.time / 0.01)), abs=1e-6)


def test_a_joint_that_another_one_stiffens():
    """By half, where the other is as far compressed as counts; before its first corner each is a spring."""
    world = one_mass()
    world.bodies["load"] = Body(-2.0, 100.0)
    mount = Joint("cart", "load", "crush_plateau", ELASTIC, [Term(Kind.DRIVEN, (0.5, 0.1), "front")])
    world.joints["mount"] = mount
    motion = run(world, SPEED, 0.05)
    front, own = (motion.deformation[name] for name in ("front", "mount"))
    assert front.max() > 0.1
    expected = STIFFNESS * np.maximum(own, 0.0) * (1.0 + 0.5 * np.clip(front / 0.1, 0.0, 1.0))
    assert motion.force["mount"] == pytest.approx(expected, abs=1e-6 * expected.max())


@pytest.mark.parametrize("number", range(4))
def test_the_wall_receives_the_momentum_that_the_bodies_lose(number):
    scene = draw_scene(np.random.default_rng([number, 1]))
    (motion, *_) = scene.motions()
    masses = {name: scene.world.bodies[name].mass for name in scene.bodies}
    inertia = sum(mass * motion.acceleration[name] for name, mass in masses.items())
    contact = motion.contact(scene.obstacle)
    assert contact.max() > 0.0
    assert contact == pytest.approx(-inertia, abs=1e-9 * contact.max())


@pytest.mark.parametrize("physics", [name for name in JOINT_EFFECTS if name != "unknown"])
def test_no_effect_of_a_joint_creates_energy(physics):
    rng = np.random.default_rng(len(physics))
    for _ in range(2):
        scene = draw_scene(rng)
        effect = EFFECTS[physics](Stage(scene, scene.motions(slice(0, 1)), rng))
        world = effect.into(scene, 1.0).world
        motion = run(world, scene.speeds[0], scene.duration)
        assert kinetic(world, motion, -1) <= kinetic(world, motion, 0) * (1.0 + 1e-6)


def test_what_is_never_compressed_cannot_bottom():
    rng = np.random.default_rng(1)
    scene = draw_scene(rng)
    motions = [evolve(motion, deformation=dict.fromkeys(motion.deformation, np.zeros(3))) for motion in scene.motions()]
    assert EFFECTS["bottoming"](Stage(scene, motions, rng)) is None


@pytest.mark.parametrize("physics", EFFECTS)
def test_every_effect_changes_the_recordings_and_vanishes_with_its_strength(physics):
    rng = np.random.default_rng(3)
    effect = None
    while effect is None:
        scene = draw_scene(rng, wall=True, complete=True)
        effect = EFFECTS[physics](Stage(scene, scene.motions(), rng))
    strengths = (effect.limits[1], 1e-4 * effect.limits[1])
    base = scene.signals(scene.motions())
    large, small = (np.linalg.norm(one.signals(one.motions()) - base) for one in (effect.into(scene, s) for s in strengths))
    assert large > 5.0
    assert small < 0.2 * large


def test_nothing_is_shared_with_the_engine():
    for path in Path(concealed.__file__).parent.glob("*.py"):
        imported = [
            name
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Import | ast.ImportFrom)
            for name in ([node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names])
        ]
        assert not [name for name in imported if name.startswith("crashkit") and not name.startswith(concealed.__name__)]


@pytest.mark.long
@pytest.mark.parametrize("number", [1, 2])
def test_the_engine_agrees_far_below_the_noise(number, tmp_path):
    """With a thousandth of the noise, and the true numbers, the engine's residual is still noise alone."""
    rng = np.random.default_rng([77, number])
    scene, registry = draw_scene(rng), load()
    for instrument in scene.instruments.values():
        instrument.std_given = True
        for sensor in instrument.sensors.values():
            sensor.noise *= 1e-3
    path = tmp_path / "model.toml"
    path.write_text(model_text(scene, None))
    model = read_model(path, registry.spring_laws, registry.observers)
    runs = {
        f"run_{number}.nc": record(scene.instruments, motion, scene.duration, scene.bodies, rng)
        for number, motion in enumerate(scene.motions())
    }
    misfit = Misfit(model, runs, registry.spring_laws, registry.observers)
    residual, samples = misfit.residual(misfit.start()), misfit.independent_samples
    assert math.sqrt(residual @ residual / samples) == pytest.approx(1.0, abs=4.0 * math.sqrt(0.5 / samples))
