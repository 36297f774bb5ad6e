"""Motions with a closed form."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.model import Body, Parameter

TIMES = np.linspace(0.0, 6.0, 121)
STEP = 2e-3


def run(simulator, model, times=TIMES, step=STEP, **others):
    return simulator(model).run(times, step=step, **others)


def position(motion, body="mass"):
    return motion["position"].sel(body=body).values[:, 0]


def velocity(motion, body="mass"):
    return motion["velocity"].sel(body=body).values[:, 0]


def test_harmonic(simulator, against_wall, plateau):
    model = against_wall("crush_plateau", plateau | {"crush_force": 1e3, "tension": 1.0}, mass=2.0, speed=0.3)
    omega = np.sqrt(1.2 / 2.0)
    motion = run(simulator, model)
    np.testing.assert_allclose(position(motion), -1.0 + 0.3 / omega * np.sin(omega * TIMES), atol=1e-11)
    np.testing.assert_allclose(velocity(motion), 0.3 * np.cos(omega * TIMES), atol=1e-11)
    np.testing.assert_allclose(
        motion["acceleration"].sel(body="mass").values[:, 0], -0.3 * omega * np.sin(omega * TIMES), atol=1e-11
    )


def test_plateau_brakes_at_a_constant_rate(simulator, against_wall, plateau):
    """Elastic up to x1 = delta / alpha at t1, then x1 + v1 (t - t1) - delta (t - t1)^2 / 2."""
    model = against_wall("crush_plateau", plateau | {"densification_deformation": 9.0})
    omega, x1 = np.sqrt(1.2), 0.2
    t1 = np.arcsin(x1 * omega) / omega
    v1 = np.sqrt(1.0 - 1.2 * x1**2)
    times = np.linspace(0.0, t1 + v1 / 0.24 - 0.01, 50)
    later = times - t1
    expected = np.where(later < 0.0, np.sin(omega * times) / omega, x1 + v1 * later - 0.12 * later**2)
    motion = run(simulator, model, times)
    np.testing.assert_allclose(motion["deformation"].values[:, 0], expected, atol=1e-12)
    np.testing.assert_allclose(motion["force"].values[-1], 0.24)


def test_plastic_rebound(simulator, against_wall, plateau):
    """Energy at the greatest deformation is v0^2 / 2; only F^2 / 2k of it comes back."""
    k = 12.0
    model = against_wall("crush_plateau", plateau | {"unloading_stiffness": k})
    motion = run(simulator, model)
    absorbed = 0.24**2 / 2.4 + 0.24 * (0.6 - 0.2)
    over = (-0.24 + np.sqrt(0.24**2 + 2.0 * 1.2 * (0.5 - absorbed))) / 1.2
    force = 0.24 + 1.2 * over
    assert velocity(motion)[-1] == pytest.approx(-force / np.sqrt(k), rel=1e-11)
    assert motion["deformation"].max() == pytest.approx(0.6 + over, rel=1e-4)


def test_flight_through_a_gap(simulator, against_wall, plateau):
    model = against_wall("crush_plateau", plateau | {"clearance": 0.5})
    straight = against_wall("crush_plateau", plateau)
    late, early = run(simulator, model, TIMES + 0.5), run(simulator, straight, TIMES)
    np.testing.assert_allclose(late["deformation"].values, early["deformation"].values + 0.5, atol=1e-11)


def test_a_free_length_shorter_than_the_distance_is_a_gap(simulator, against_wall, plateau):
    model = against_wall("crush_plateau", plateau, free_length=Parameter(0.5))
    straight = against_wall("crush_plateau", plateau)
    late, early = run(simulator, model, TIMES + 0.5), run(simulator, straight, TIMES)
    np.testing.assert_allclose(late["deformation"].values, early["deformation"].values, atol=1e-11)


def test_dashpot(simulator, against_wall):
    """In full contact from the start the speed decays exponentially."""
    model = against_wall("viscous", {"damping": 0.7}, mass=2.0, free_length=Parameter(1.5))
    motion = run(simulator, model)
    np.testing.assert_allclose(velocity(motion), np.exp(-0.35 * TIMES), atol=1e-11)


def test_joints_between_the_same_bodies_add_up(simulator, against_wall, joint, plateau):
    one = against_wall("linear_stop", {"stiffness": 3.0, "stop_deformation": 0.0})
    half = [joint(name, ("wall", "mass"), "linear_stop", {"stiffness": 1.5, "stop_deformation": 0.0}) for name in "ab"]
    two = evolve(one, joints=tuple(half))
    np.testing.assert_allclose(position(run(simulator, two)), position(run(simulator, one)), atol=1e-13)


def test_factors_multiply(simulator, against_wall, plateau):
    times = [0.1]
    model = against_wall(
        "crush_plateau", plateau | {"rate_amplitude": 0.5, "reference_rate": 2.0}, factors=("rate_logarithm",)
    )
    motion = run(simulator, model, times)
    rate = motion["deformation_rate"].values[0, 0]
    expected = 1.2 * motion["deformation"].values[0, 0] * (1.0 + 0.5 * np.log(1.0 + rate / 2.0))
    assert motion["force"].values[0, 0] == pytest.approx(expected, rel=1e-13)


def test_bodies_that_would_pass_through_each_other_go_on_pushing(simulator, against_wall):
    model = against_wall("linear_stop", {"stiffness": 0.01, "stop_deformation": 0.0}, speed=1.0)
    motion = run(simulator, model)
    assert position(motion)[-1] > 1.0
    np.testing.assert_allclose(motion["force"].values[:, 0], 0.01 * (position(motion) + 1.0), atol=1e-14)


def test_reloading_climbs_the_unloading_line_back(simulator, against_wall, joint, plateau):
    """A second mass, thrown after the first, loads its spring again: force and deformation stay on the line up to d_max."""
    model = against_wall("crush_plateau", plateau | {"unloading_stiffness": 12.0})
    chaser = Body("chaser", (-4.0,), (1.5,), Parameter(2.0))
    link = joint(
        "link", ("mass", "chaser"), "linear_stop", {"stiffness": 50.0, "stop_deformation": 0.0}, free_length=Parameter(0.5)
    )
    model = evolve(model, bodies=(*model.bodies, chaser), joints=(*model.joints, link))
    motion = run(simulator, model, np.linspace(0.0, 6.0, 3001))
    d, force = motion["deformation"].values[:, 0], motion["force"].values[:, 0]
    largest = np.maximum.accumulate(d)
    loading = np.where(largest < 0.2, 1.2 * largest, np.where(largest < 0.6, 0.24, 0.24 + 1.2 * (largest - 0.6)))
    np.testing.assert_allclose(force, np.maximum(0.0, loading - 12.0 * (largest - d)), atol=1e-4)
    changes = np.count_nonzero(np.diff((np.diff(largest) > 0.0).astype(int)))
    assert changes >= 3, "expected loading, unloading, loading beyond the largest deformation, unloading"
