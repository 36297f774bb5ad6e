"""Small changes to a model: each gives a new one, and leaves the given one as it was."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from crashkit.errors import CrashkitError
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.edit import (
    fresh_name,
    with_body,
    with_changed_joint,
    with_factor,
    with_instrument_error,
    with_joint,
    without_joint,
)

MODEL = Model(
    "model",
    ("x",),
    (Body("wall", (0.0,), (0.0,), fixed=True), Body("car", (-1.0,), (10.0,), Parameter(1000.0))),
    (
        Joint("front", ("wall", "car"), "linear_stop", {"stiffness": Parameter(1e5)}),
        Joint("side", ("wall", "car"), "linear_stop", {"stiffness": Parameter(2e5)}),
    ),
)
GAIN = Parameter(1.0, 0.5, 2.0)


def test_a_joint_and_a_body_come_last():
    body, joint = Body("load", (-1.0,), (10.0,), Parameter(50.0)), Joint("tie", ("car", "load"), "tie", {})
    changed = with_joint(with_body(MODEL, body), joint)
    assert changed.bodies == (*MODEL.bodies, body)
    assert changed.joints == (*MODEL.joints, joint)
    assert len(MODEL.bodies) == len(MODEL.joints) == 2


def test_a_joint_is_taken_away():
    assert without_joint(MODEL, "front").joints == MODEL.joints[1:]
    message = r'^model model: expected one of the joints \("front", "side"\), found "rear"$'
    with pytest.raises(CrashkitError, match=message):
        without_joint(MODEL, "rear")


def test_one_joint_is_changed():
    changed = with_changed_joint(MODEL, "front", law="hook", factors=("rate_linear",))
    assert (changed.joint("front").law, changed.joint("front").factors) == ("hook", ("rate_linear",))
    assert changed.joint("front").parameters == MODEL.joint("front").parameters
    assert changed.joint("side") == MODEL.joint("side")


def test_a_factor_multiplies_one_joint_and_adds_its_parameters():
    slope = Parameter(0.1, 0.0, 1.0)
    changed = with_factor(MODEL, "front", "rate_linear", {"rate_slope": slope})
    assert changed.joint("front").factors == ("rate_linear",)
    assert changed.parameters()["joint.front.rate_slope"] == slope
    assert changed.parameters()["joint.front.stiffness"] == Parameter(1e5)
    assert changed.joint("side") == MODEL.joint("side")


def test_a_factor_needs_a_joint():
    with pytest.raises(CrashkitError, match='expected one of the joints .*, found "rear"'):
        with_factor(MODEL, "rear", "rate_linear", {})


def test_factors_multiply_each_other():
    changed = with_factor(with_factor(MODEL, "side", "first", {}), "side", "second", {})
    assert changed.joint("side").factors == ("first", "second")


def test_errors_of_one_sensor_are_kept_together():
    changed = with_instrument_error(MODEL, "film", "roof", "gain", GAIN)
    changed = with_instrument_error(changed, "film", "", "clock_offset", Parameter(0.0))
    changed = with_instrument_error(changed, "film", "roof", "bias", Parameter(1e-3))
    assert set(changed.parameters()) - set(MODEL.parameters()) == {
        "instrument.film.roof.gain",
        "instrument.film.roof.bias",
        "instrument.film..clock_offset",
    }
    assert len(changed.instruments) == 2
    assert changed.parameters()["instrument.film.roof.gain"] == GAIN


def test_an_error_that_is_set_again_is_replaced():
    changed = with_instrument_error(MODEL, "film", "roof", "gain", GAIN)
    changed = with_instrument_error(changed, "film", "roof", "gain", Parameter(1.2))
    assert changed.parameters()["instrument.film.roof.gain"] == Parameter(1.2)


@given(taken=st.lists(st.sampled_from(["load", "load_2", "load_3", "load_4", "ground"])))
def test_a_fresh_name_is_free_and_the_first_of_its_kind(taken):
    name = fresh_name("load", taken)
    assert name not in taken
    earlier = ["load", "load_2", "load_3", "load_4", "load_5"]
    assert set(earlier[: earlier.index(name)]) <= set(taken)


@pytest.mark.parametrize(("taken", "name"), [([], "load"), (["load"], "load_2"), (["load", "load_2"], "load_3")])
def test_names_are_numbered_from_two(taken, name):
    assert fresh_name("load", iter(taken)) == name
