"""Accelerometers that contradict their film are set aside, and nothing else is."""

from functools import partial

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.diagnose.locate.aside import Suspect, late_clocks, on_time, suspects, without
from crashkit.diagnose.locate.consistency import by_run, check_instruments
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_instrument_error, with_joint
from crashkit.protocols import Proposal
from crashkit.testing import toys

BIAS = "instrument.accelerometer.front_sensor.bias"


@pytest.fixture
def doubted(recorded, misfit, model):
    """The suspects in two runs whose accelerometers were tampered with."""

    def doubt(**changes):
        both = misfit(model, slow=recorded(model, 0.9, 1, **changes), fast=recorded(model, 1.2, 2, **changes))
        return suspects(both, checked(both))

    return doubt


def checked(misfit):
    return check_instruments(by_run(misfit))


def shifted(dataset):
    """The zero jumps in mid-run, which is neither an offset nor a sensitivity."""
    return dataset.assign(acceleration=dataset["acceleration"] + 8.0 * (dataset["time"] > 0.05))


def late(dataset, by=8):
    values = dataset["acceleration"].values
    return dataset.assign(acceleration=(dataset["acceleration"].dims, np.concatenate([0.0 * values[:by], values[:-by]])))


def test_instruments_that_agree_are_not_suspected(doubted):
    assert doubted() == ()


def test_a_sensor_whose_zero_shifts_is_suspected(doubted):
    (suspect,) = doubted(accelerometer=shifted)
    assert (suspect.body, suspect.instrument, suspect.sensors) == ("front", "accelerometer", ("front_sensor",))


def test_how_late_film_and_accelerometer_are_against_each_other_is_known_before_which_of_them_is(recorded, misfit, model):
    clocks = late_clocks(checked(misfit(model, slow=recorded(model, 0.9, 1, accelerometer=late))))
    assert clocks == {"film": pytest.approx(-2e-3, abs=1e-4), "accelerometer": pytest.approx(2e-3, abs=1e-4)}


def test_clocks_are_right_where_something_else_explains_the_contradiction(recorded, misfit, model):
    assert late_clocks(checked(misfit(model, slow=recorded(model, 0.9, 1)))) == {}
    assert late_clocks(checked(misfit(model, slow=recorded(model, 0.9, 1, accelerometer=shifted)))) == {}


def test_a_clock_is_late_where_most_bodies_say_so(recorded, misfit, model):
    def said_of(body, change):
        checks = checked(misfit(model, slow=recorded(model, 0.9, 1, accelerometer=change)))
        return checks.assign(body=("check", [body] * checks.sizes["check"]))

    front, rear, sensor = said_of("front", late), said_of("rear", late), said_of("engine", shifted)
    assert late_clocks(xr.concat([front, rear, sensor], "check")) == late_clocks(front) != {}
    assert late_clocks(xr.concat([front, sensor], "check")) == {}


def test_the_clock_that_a_third_instrument_agrees_with_is_right(recorded, misfit, model):
    def said(**renamed):
        checks = checked(misfit(model, slow=recorded(model, 0.9, 1)))
        return checks.assign({what: ("check", [name] * checks.sizes["check"]) for what, name in renamed.items()})

    contradicted = checked(misfit(model, slow=recorded(model, 0.9, 1, accelerometer=late)))
    of_film = late_clocks(xr.concat([contradicted, said(accelerometer="recorder")], "check"))
    assert of_film == {"accelerometer": pytest.approx(2e-3, abs=1e-4)}
    of_accelerometer = late_clocks(xr.concat([contradicted, said(film="second camera")], "check"))
    assert of_accelerometer == {"film": pytest.approx(-2e-3, abs=1e-4)}
    of_both = late_clocks(xr.concat([contradicted, said(film="second camera", accelerometer="recorder")], "check"))
    assert set(of_both) == {"film", "accelerometer"}


def test_stamps_are_put_right(recorded, model):
    run = recorded(model)
    right = on_time({"run": run}, "film", 0.0105)["run"]
    stamps = run["film"]["time"].values - 0.0105
    np.testing.assert_allclose(right["film"]["time"], stamps[stamps >= 0.0])
    np.testing.assert_array_equal(right["film"]["position"], run["film"]["position"][stamps >= 0.0])
    assert right["accelerometer"].identical(run["accelerometer"])
    assert on_time({"run": run}, "lidar", 0.01)["run"].identical(run)


def test_what_is_set_aside_leaves_the_other_instruments_as_they_were(doubted, recorded, model):
    run = recorded(model, accelerometer=shifted)
    rest = without({"run": run}, doubted(accelerometer=shifted))["run"]
    assert set(run.children) - set(rest.children) == {"accelerometer"}
    assert rest["film"].identical(run["film"])
    assert "accelerometer" in run.children


def test_sensors_of_other_bodies_stay(recorded, misfit):
    model = toys.two_degrees()
    first, second = (body.name for body in model.bodies if not body.fixed)

    def first_shifted(dataset):
        jump = 8.0 * (dataset["time"] > 0.05) * (dataset["sensor_body"] == first)
        return dataset.assign(acceleration=dataset["acceleration"] + jump)

    run = recorded(model, accelerometer=first_shifted)
    both = misfit(model, run=run)
    found = suspects(both, checked(both))
    assert [suspect.body for suspect in found] == [first]
    rest = without({"run": run}, found)["run"]
    assert rest["accelerometer"]["sensor_body"].values.tolist() == [second]


def test_only_readings_of_its_body_concern_a_suspect(doubted, model):
    (suspect,) = doubted(accelerometer=shifted)
    wrong = with_instrument_error(model, "accelerometer", "front_sensor", "bias", Parameter(0.0))
    dashpot = Joint("dashpot", ("wall", "front"), "viscous", {"damping": Parameter(1.0)})
    dashed, damping = with_joint(model, dashpot), "joint.dashpot.damping"

    def proposal(changed, *paths, **place):
        return Proposal("any", "", place, changed, paths, {})

    assert suspect.concerns(proposal(wrong, BIAS, sensor="front_sensor"))
    assert suspect.concerns(proposal(wrong, BIAS, body="front"))
    assert suspect.concerns(proposal(with_joint(wrong, dashpot), BIAS, damping, body="front"))
    assert suspect.concerns(proposal(wrong, BIAS, instrument="accelerometer"))
    assert not suspect.concerns(proposal(wrong, BIAS, instrument="film"))
    assert not suspect.concerns(proposal(wrong, BIAS, sensor="rear_sensor"))
    assert not suspect.concerns(proposal(dashed, damping, body="front"))


def test_what_kinematics_tell_of_a_sensor_is_all_that_it_is_accused_of(doubted, model):
    def weak(dataset):
        return dataset.assign(acceleration=0.87 * dataset["acceleration"])

    def off(dataset):
        return dataset.assign(acceleration=dataset["acceleration"] + 8.0)

    assert [suspect.told for suspect in doubted(accelerometer=weak)] == ["gain_error"]
    assert [suspect.told for suspect in doubted(accelerometer=off)] == ["bias"]
    assert [suspect.told for suspect in doubted(accelerometer=shifted)] == [""]
    (suspect,) = doubted(accelerometer=weak)
    wrong = with_instrument_error(model, "accelerometer", "front_sensor", "bias", Parameter(0.0))
    accused = partial(Proposal, form="", location={"sensor": "front_sensor"}, model=wrong, parameters=(BIAS,), null={})
    claims = [accused(physics) for physics in ("gain_error", "misalignment")]
    assert [suspect.concerns(claim) for claim in claims] == [True, False]
    assert suspect.concerns(evolve(claims[1], odds=10.0))  # its other channels say so


def test_beside_a_sensor_that_is_wrong_the_others_of_its_body_stay_accused(model):
    pair = Suspect("front", "accelerometer", ("left", "right"))

    def found(**place):
        wrong = with_instrument_error(model, "accelerometer", "left", "bias", Parameter(0.0))
        return Proposal("any", "", place, wrong, (BIAS,), {})

    alone = pair.besides(found(sensor="left"))
    assert alone == Suspect("front", "accelerometer", ("right",))
    assert alone.besides(found(sensor="right")) is None
    assert pair.besides(found(body="front")) is None
    assert pair.besides(found(sensor="elsewhere")) == pair
