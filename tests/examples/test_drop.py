"""A parcel that falls on a corner tumbles."""

import numpy as np
import pytest


@pytest.fixture(scope="module")
def motion(motion_of):
    return motion_of("drop/corner_drop")


def test_the_lowest_corner_lands_first(motion):
    force = motion["force"]
    first = {str(name): np.argmax(force.sel(joint=name).values > 0.0) for name in force["joint"].values}
    assert min(first, key=lambda name: first[name]) == "corner_front_right"
    assert force.sel(joint="corner_front_right").values[0] == 0.0


def test_it_tumbles_about_both_level_axes(motion):
    spin = motion["angular_velocity"].sel(body="parcel").isel(time=-1).values
    assert np.abs(spin[:2]).min() > 1.0


def test_in_free_flight_it_falls_and_keeps_its_angular_momentum(model_of, motion):
    from scipy.spatial.transform import Rotation

    parcel = motion.sel(body="parcel")
    flight = (motion["force"].sum("joint") == 0.0).values
    assert flight.sum() > 100
    assert parcel["acceleration"].values[flight] == pytest.approx(np.tile([0.0, 0.0, -9.81], (flight.sum(), 1)), abs=1e-9)
    turn = Rotation.from_quat(parcel["orientation"].values, scalar_first=True)
    inertia = np.array([entry.value for entry in model_of("drop/corner_drop").body("parcel").inertia])
    spin = turn.apply(inertia * turn.inv().apply(parcel["angular_velocity"].values))
    last = np.flatnonzero(~flight)[-1] + 1
    assert spin[last:] == pytest.approx(np.broadcast_to(spin[-1], spin[last:].shape), abs=1e-9)


def test_the_ground_only_pushes_up(motion):
    ground = motion["contact_force"].sel(body="ground").values
    assert (ground[:, :2] == 0.0).all()
    assert (ground[:, 2] <= 0.0).all()
