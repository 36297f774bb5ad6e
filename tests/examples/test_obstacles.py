"""Each obstacle does to the car what its comment says."""

import numpy as np
import pytest

SINGLE_BODY = ("rigid_barrier", "oblique_barrier", "offset_barrier", "pole")


def speed(motion, body):
    return motion["velocity"].sel(body=body, axis="x").values


def last(motion, quantity, body, axis):
    return float(motion[quantity].sel(body=body, axis=axis).isel(time=-1))


def test_the_car_is_the_same(model_of):
    cars = [model_of(f"obstacles/{name}").body("car") for name in SINGLE_BODY]
    assert all(car == cars[0] for car in cars)


def test_a_rigid_barrier_stops_the_car_straight(motion_of, yaw):
    motion = motion_of("obstacles/rigid_barrier")
    crush = float(motion["position"].sel(body="car", axis="x").max()) + 2.1
    assert 0.4 < crush < 0.7
    assert -4.0 < last(motion, "velocity", "car", "x") < 0.0
    assert np.abs(yaw(motion, "car")).max() < 1e-9


def test_contact_begins_and_ends(motion_of):
    force = motion_of("obstacles/rigid_barrier")["force"]
    for joint in force["joint"].values:
        pressed = np.flatnonzero(force.sel(joint=joint).values > 0.0)
        assert (np.diff(pressed) == 1).all()
        assert pressed[-1] < force.sizes["time"] - 1
    assert float(force["time"][np.argmax(force.sel(joint="engine").values > 0.0)]) == pytest.approx(0.35 / 13.9, rel=0.5)


def test_an_oblique_barrier_turns_the_car_away(motion_of, yaw):
    motion = motion_of("obstacles/oblique_barrier")
    assert -30.0 < yaw(motion, "car")[-1] < -5.0
    assert last(motion, "position", "car", "y") < -0.3
    assert 0.0 < last(motion, "velocity", "car", "x") < 6.0


def test_an_oblique_barrier_pushes_along_its_normal(motion_of):
    force = motion_of("obstacles/oblique_barrier")["contact_force"].sel(body="car").values
    assert force @ [-0.5, np.sqrt(0.75), 0.0] == pytest.approx(0.0, abs=1e-4 * np.abs(force).max())


def test_an_offset_barrier_turns_the_car_about_its_edge(motion_of, yaw):
    motion = motion_of("obstacles/offset_barrier")
    assert 10.0 < yaw(motion, "car")[-1] < 40.0
    assert float(motion["deformation"].max()) < 0.9


def test_a_pole_enters_between_the_rails(motion_of, yaw):
    motion = motion_of("obstacles/pole")
    assert 0.5 < float(motion["deformation"].sel(joint="engine").max()) < 0.8
    assert 2.0 < yaw(motion, "car")[-1] < 20.0
    assert float(motion["deformation"].sel(joint="bumper_beam_left").max()) > float(
        motion["deformation"].sel(joint="bumper_beam_right").max()
    )


def test_a_deformable_barrier_stays_crushed(motion_of, yaw):
    motion = motion_of("obstacles/deformable_barrier")
    honeycomb = motion["deformation"].sel(joint="honeycomb_right")
    assert float(honeycomb.max()) > 0.3
    assert float(honeycomb.isel(time=-1)) > 0.8 * float(honeycomb.max())
    assert abs(last(motion, "velocity", "car", "x")) < 3.0
    assert yaw(motion, "car")[-1] > 2.0


@pytest.mark.parametrize("name", ["movable_barrier", "another_vehicle"])
def test_where_nothing_is_fixed_momentum_is_kept(name, model_of, motion_of):
    model, motion = model_of(f"obstacles/{name}"), motion_of(f"obstacles/{name}")
    masses = np.array([body.mass.value for body in model.bodies])
    inertia = np.array([body.inertia[0].value for body in model.bodies])
    momentum = np.einsum("b,tba->ta", masses, motion["velocity"].values)
    spin = np.einsum("b,tba->ta", masses, np.cross(motion["position"].values, motion["velocity"].values))
    spin += np.einsum("b,tba->ta", inertia, motion["angular_velocity"].values)
    assert momentum == pytest.approx(np.broadcast_to(momentum[0], momentum.shape), abs=1e-6 * masses @ [20.0, 20.0])
    assert spin == pytest.approx(np.broadcast_to(spin[0], spin.shape), abs=1e-5 * inertia.sum())


def test_a_movable_barrier_shares_its_speed(motion_of, yaw):
    motion = motion_of("obstacles/movable_barrier")
    assert last(motion, "velocity", "barrier", "x") - last(motion, "velocity", "car", "x") < 4.0
    assert last(motion, "velocity", "car", "x") < -8.0
    assert yaw(motion, "car")[-1] > 5.0
    assert yaw(motion, "barrier")[-1] > 5.0


def test_two_cars_yaw_and_the_lighter_is_thrown_back(motion_of, yaw):
    motion = motion_of("obstacles/another_vehicle")
    assert yaw(motion, "car")[-1] > 10.0
    assert yaw(motion, "other_car")[-1] > yaw(motion, "car")[-1]
    assert np.abs(speed(motion, "other_car") + 13.9).max() > np.abs(speed(motion, "car") - 13.9).max()


def test_the_weaker_of_two_rails_folds_first(motion_of):
    rails = motion_of("obstacles/another_vehicle").sel(joint="left_rails")
    static = (rails["force"] / (1.0 + 0.01 * rails["deformation_rate"])).where(rails["deformation_rate"] > 0.0)
    assert static.where((rails["deformation"] > 0.06) & (rails["deformation"] < 0.65)).max() == pytest.approx(70e3)
    assert static.where(rails["deformation"] > 0.72).min() == pytest.approx(85e3, rel=1e-3)
