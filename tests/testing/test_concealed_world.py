"""The hidden world against closed-form mechanics and the energy that it may not create."""

import math

import numpy as np
import pytest

from crashkit.testing.concealed.world import World, WorldJoint, run

MASS, STIFFNESS, SPEED = 900.0, 1.1e6, 9.0


def one_mass(**fields: float) -> World:
    bodies = {"barrier": {"position": 0.0, "moving": 0.0}, "body": {"position": -1.0, "mobility": 1.0 / MASS}}
    return World(bodies, {"front": WorldJoint("barrier", "body", {"elastic_stiffness": STIFFNESS, **fields})})


def rebound(world: World, body: str = "body", duration: float = 0.2) -> float:
    """Speed at the end, m s-1."""
    trace = run(world, SPEED, duration)
    return float(np.gradient(trace.position[body], trace.time)[-1])


def test_an_elastic_rebound_is_half_a_sine() -> None:
    pulsation = math.sqrt(STIFFNESS / MASS)
    trace = run(one_mass(), SPEED, math.pi / pulsation)
    expected = SPEED / pulsation * np.sin(pulsation * trace.time)
    assert trace.deformation["front"] == pytest.approx(expected, abs=1e-8)
    assert trace.acceleration["body"] == pytest.approx(-(pulsation**2) * expected, abs=1e-4)


def test_an_elastic_rebound_gives_all_energy_back() -> None:
    assert rebound(one_mass(crush_force=1.5e5)) == pytest.approx(-SPEED, rel=1e-6)


def test_plastic_unloading_gives_back_what_the_line_encloses() -> None:
    force, unloading = 1.2e5, 5e6
    speed = rebound(one_mass(crush_force=force, unloading_stiffness=unloading))
    assert 0.5 * MASS * speed**2 == pytest.approx(force**2 / (2.0 * unloading), rel=1e-4)


def test_the_crush_of_a_plateau_takes_up_the_kinetic_energy() -> None:
    force = 1.2e5
    deepest = run(one_mass(crush_force=force), SPEED, 0.2).deformation["front"].max()
    elastic = force / STIFFNESS
    assert force * (deepest - elastic) + 0.5 * force * elastic == pytest.approx(0.5 * MASS * SPEED**2, rel=1e-5)


def test_densification_follows_the_plateau() -> None:
    trace = run(one_mass(crush_force=5e4, densification_deformation=0.2, densification_stiffness=4e5), SPEED, 0.1)
    deformation, force = trace.deformation["front"], trace.force["front"]
    loading = slice(0, int(deformation.argmax()))
    expected = np.minimum(STIFFNESS * deformation, 5e4) + 4e5 * np.maximum(deformation - 0.2, 0.0)
    assert force[loading] == pytest.approx(expected[loading], abs=1e-6)


def test_a_damper_alone_slows_down_exponentially() -> None:
    world = one_mass(damping=2e4, damping_always=1.0)
    world.joints["front"].fields["elastic_stiffness"] = 0.0
    assert rebound(world) == pytest.approx(SPEED * math.exp(-2e4 / MASS * 0.2), rel=1e-3)


def test_a_linear_rate_factor_multiplies_the_static_force() -> None:
    trace = run(one_mass(rate_linear=0.03), SPEED, 0.03)
    rate = np.gradient(trace.deformation["front"], trace.time)
    expected = STIFFNESS * trace.deformation["front"] * (1.0 + 0.03 * rate)
    assert trace.force["front"][2:-2] == pytest.approx(expected[2:-2], rel=1e-3)


def test_a_maxwell_branch_fades_with_its_time() -> None:
    """Stretched at a constant rate, its force tends to stiffness * time * rate."""
    world = one_mass(branch_stiffness=1e5, branch_time=0.004)
    world.bodies["body"]["mobility"] = 1e-12
    world.joints["front"].fields["elastic_stiffness"] = 0.0
    trace = run(world, SPEED, 0.03)
    expected = 1e5 * 0.004 * SPEED * (1.0 - np.exp(-trace.time / 0.004))
    assert trace.force["front"][1:] == pytest.approx(expected[1:], rel=2e-3)


def test_ground_friction_stops_a_body_after_the_known_way() -> None:
    world = one_mass()
    world.joints["front"].fields["elastic_stiffness"] = 0.0
    world.bodies["body"] |= {"friction": 5e4, "friction_velocity": 0.01}
    trace = run(world, SPEED, 0.3)
    assert trace.position["body"][-1] + 1.0 == pytest.approx(MASS * SPEED**2 / (2.0 * 5e4), rel=1e-3)


def test_two_bodies_exchange_momentum_only() -> None:
    world = one_mass(crush_force=1e5, unloading_stiffness=5e6)
    world.bodies["rear"] = {"position": -2.0, "mobility": 1.0 / 400.0}
    world.joints["mount"] = WorldJoint("body", "rear", {"elastic_stiffness": 3e5, "rate_power_size": 0.3, "rate_power": 0.3})
    trace = run(world, SPEED, 0.15)
    momentum = MASS * trace.acceleration["body"] + 400.0 * trace.acceleration["rear"]
    assert momentum == pytest.approx(-trace.contact["barrier"], abs=1e-6)
    assert trace.contact["barrier"].max() == pytest.approx(1e5)


def test_fracture_loses_force_for_good() -> None:
    trace = run(one_mass(fracture_loss=0.5, fracture_deformation=0.1, fracture_width=1e-3), SPEED, 0.15)
    deformation, force = trace.deformation["front"], trace.force["front"]
    broken = int(np.argmax(deformation > 0.102))
    assert force[:broken].max() == pytest.approx(STIFFNESS * 0.1, rel=0.05)
    assert force[broken:] == pytest.approx(0.5 * STIFFNESS * np.maximum(deformation[broken:], 0.0), rel=1e-9)
