"""Figure 3: four bodies, 14 springs, 80 ms, and the same car against two other barriers."""

import runpy

import numpy as np
import pytest

from crashkit.mechanics import Simulator
from crashkit.registry import load

G = 9.80665
BODIES = ("compartment", "engine", "subframe", "crossmember")
SIDES = [("left", "right"), ("right", "left")]


@pytest.fixture(scope="module")
def motion(motion_of):
    return motion_of("figure-3/orthogonal")


def test_four_bodies_and_fourteen_springs(model_of):
    model = model_of("figure-3/orthogonal")
    assert [body.name for body in model.bodies if not body.fixed] == list(BODIES)
    assert len(model.joints) == 14


@pytest.mark.parametrize("barrier", ["oblique", "offset"])
def test_the_same_car(barrier, model_of):
    model, other = model_of("figure-3/orthogonal"), model_of(f"figure-3/{barrier}")
    assert model.bodies[1:] == other.bodies[1:]
    left_out = {"bumper_right"} if barrier == "offset" else set()
    assert [joint for joint in model.joints if joint.name not in left_out] == list(other.joints)


def test_the_car_is_symmetric_and_stays_so(motion):
    assert np.abs(motion["position"].sel(axis="y")).max() < 1e-6
    assert np.abs(motion["angular_velocity"]).max() < 1e-5
    for name in ("bumper", "rail", "brace", "subframe", "engine_mount", "radiator", "firewall"):
        left, right = (motion["force"].sel(joint=f"{name}_{side}").values for side in ("left", "right"))
        assert left == pytest.approx(right, abs=1.0)


def test_displacements_and_speeds_are_of_the_papers_size(motion):
    assert motion["time"].values[-1] == 0.08
    crush = motion["position"].sel(axis="x") - motion["position"].sel(axis="x").isel(time=0)
    assert 0.55 < float(crush.sel(body="compartment").max()) < 0.75
    assert float(crush.sel(body="crossmember").max()) < float(crush.sel(body="engine").max())
    assert float(crush.sel(body="engine").max()) < float(crush.sel(body="compartment").max())
    assert np.abs(motion["velocity"].sel(axis="x", body=list(BODIES)).isel(time=-1)).max() < 3.0


def test_decelerations_are_of_the_papers_size(motion):
    deceleration = -motion["acceleration"].sel(axis="x") / G
    peaks = {body: float(deceleration.sel(body=body).max()) for body in BODIES}
    assert 25.0 < peaks["compartment"] < 45.0
    assert peaks["compartment"] < peaks["engine"] < peaks["crossmember"] < 200.0
    assert float(deceleration.min()) > -100.0


def test_the_engine_is_stopped_after_the_crossmember_and_pushed_on_by_the_compartment(motion):
    force = motion["force"]
    begins = {name: float(force["time"][np.argmax(force.sel(joint=name).values > 1.0)]) for name in force["joint"].values}
    assert begins["bumper_left"] < begins["radiator_left"] < begins["firewall_left"]


@pytest.mark.parametrize(("barrier", "low", "high"), [("oblique", -10.0, -2.0), ("offset", 4.0, 15.0)])
def test_oblique_and_offset_the_car_yaws(barrier, low, high, motion_of, yaw):
    motion = motion_of(f"figure-3/{barrier}")
    assert low < yaw(motion, "compartment")[-1] < high
    assert float(np.abs(motion["velocity"].sel(axis="y")).max()) > 0.5


def test_corners_are_met_exactly_beside_joints_that_are_at_rest(model_of):
    """Where joints are at rest, some guards are 0 but for rounding: they must not hide a corner within the same step."""
    simulator = Simulator(model_of("figure-3/oblique"), load().spring_laws)
    coarse, fine = (simulator.run(np.linspace(0.0, 0.08, 81), step=step) for step in (1e-4, 2.5e-5))
    assert np.abs(coarse["position"] - fine["position"]).max() < 1e-8


def test_the_program_draws_the_pictures(tmp_path, examples):
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("Agg")
    program = runpy.run_path(str(examples / "figure-3" / "figure_3.py"))
    program["draw_curves"](tmp_path / "figure_3.png")
    program["draw_yaw"](tmp_path / "yaw.png")
    assert all((tmp_path / name).stat().st_size > 10_000 for name in ("figure_3.png", "yaw.png"))
