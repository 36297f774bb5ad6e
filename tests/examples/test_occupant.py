"""A belt does nothing until its slack is gone, and then pulls."""

import numpy as np
import pytest

BELTS = {"lap_belt": 0.03, "shoulder_belt": 0.06}
SEATED = ["seat_back", "knee_bolster"]


@pytest.fixture(scope="module")
def motion(motion_of):
    return motion_of("occupant/belt_slack")


@pytest.mark.parametrize(("belt", "slack"), BELTS.items())
def test_is_slack_then_pulls(motion, belt, slack):
    joint = motion.sel(joint=belt)
    assert float(joint["deformation"].isel(time=0)) == pytest.approx(slack, abs=2e-3)
    loose = joint["deformation"].values >= 0.0
    assert (joint["force"].values[loose] == 0.0).all()
    assert (joint["force"].values[~loose] < 0.0).all()
    assert 0.03 < float(joint["time"][np.argmin(loose)]) < 0.06
    assert -15e3 < float(joint["force"].min()) < -5e3


def test_the_car_moves_as_it_is_told(model_of, motion):
    given = model_of("occupant/belt_slack").body("car").motion
    found = motion["position"].sel(body="car").interp(time=list(given.time)).sel(axis=["x", "z"])
    assert found.values == pytest.approx(np.array(given.position), abs=2e-5)


def test_the_seat_carries_him_before_the_crash(motion):
    early = motion.sel(time=slice(0.0, 0.01))
    assert early["force"].sel(joint="seat_cushion").values == pytest.approx(608.0, rel=0.02)
    assert (early["force"].sel(joint=SEATED) == 0.0).all()
    assert np.abs(early["velocity"].sel(body="occupant", axis="z")).max() < 0.02


def test_he_flies_forward_and_bows(motion):
    forward = motion["position"].sel(axis="x", body="occupant") - motion["position"].sel(axis="x", body="car")
    assert 0.2 < float(forward.max()) < 0.4
    w, _, y, _ = motion["orientation"].sel(body="occupant").transpose("quaternion", "time").values
    assert np.degrees(2.0 * np.arctan2(y, w)).max() > 20.0


def test_without_slack_he_is_held_earlier_and_softer(model_of, run, motion):
    model = model_of("occupant/belt_slack")
    values = {f"joint.{belt}.free_length": model.joint(belt).free_length.value - slack for belt, slack in BELTS.items()}
    tight = run(model.with_values(values), float(motion["time"][-1]))
    slack, tight = (-each["acceleration"].sel(body="occupant", axis="x").values for each in (motion, tight))
    assert tight.max() < slack.max()
    assert np.argmax(tight > 100.0) < np.argmax(slack > 100.0)
