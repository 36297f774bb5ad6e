"""The force that the recordings ask for and the model does not give."""

import numpy as np
import pytest

from crashkit.diagnose.locate.forces import binned, missing_force, on_joint, recorded_motion
from crashkit.mechanics.along import forces_along
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.testing import toys


@pytest.fixture(scope="module")
def believed():
    return toys.two_degrees()


@pytest.fixture(scope="module")
def true(believed):
    """The believed model with a stop beside its second joint."""
    stop = {"stiffness": Parameter(3e5, fixed=True), "stop_deformation": Parameter(0.05, fixed=True)}
    return with_joint(believed, Joint("stop", ("front", "rear"), "linear_stop", stop))


def test_a_spring_that_was_left_out_is_what_is_missing(workshop, believed, true, simulated):
    motion = simulated(true).assign(observed=("body", [False, True, True]))
    missing = missing_force(believed, workshop.laws, motion)
    force = motion["force"].sel(joint="stop").values
    assert force.max() > 1e4
    assert missing.sel(body="front", axis="x").values == pytest.approx(force, abs=1e-3 * force.max())
    assert missing.sel(body="rear", axis="x").values == pytest.approx(-force, abs=1e-3 * force.max())
    assert np.isnan(missing.sel(body="wall")).all()


@pytest.mark.parametrize("observed", [(False, True, True), (False, True, False), (False, False, True)])
def test_each_end_that_is_observed_tells_of_a_joint(workshop, believed, true, simulated, observed):
    motion = simulated(true).assign(observed=("body", list(observed)))
    force = on_joint(missing_force(believed, workshop.laws, motion), ("front", "rear"), np.array([[-1.0]]))
    expected = motion["force"].sel(joint="stop").values
    assert force == pytest.approx(expected, abs=1e-3 * expected.max())


def test_the_order_of_a_joints_bodies_does_not_matter(workshop, believed, true, simulated):
    missing = missing_force(believed, workshop.laws, simulated(true).assign(observed=("body", [False, True, True])))
    one, other = (("front", "rear"), -1.0), (("rear", "front"), 1.0)
    assert np.array_equal(*(on_joint(missing, bodies, np.array([[side]])) for bodies, side in (one, other)), equal_nan=True)


def test_the_true_model_misses_nothing(workshop, true, simulated):
    motion = simulated(true).assign(observed=("body", [False, True, True]))
    missing = missing_force(true, workshop.laws, motion).sel(body=["front", "rear"])
    assert np.abs(missing).max() < 1e-3 * float(np.abs(forces_along(true, workshop.laws, motion)["force"]).max())


def test_accelerations_are_those_of_the_instruments(workshop, model, recorded, misfit, simulated):
    """The simulation of a wrong model lends the rest, and what no instrument saw."""
    wrong = model.with_values({"joint.first.crush_force": 1.5e4})
    one = misfit(wrong, run=recorded(model, noise=0.0))
    simulation = one.predictor.motion("run", one.values(one.start()))
    motion = recorded_motion(one, "run", simulation, workshop.smoother)
    truth = simulated(model, 1.0, simulation["time"].values)["acceleration"]
    assert motion["observed"].values.tolist() == [[False], [True]]
    assert np.abs((motion["acceleration"] - truth).sel(body="front")).max() < 1e-6 * np.abs(truth).max()
    assert np.abs((simulation["acceleration"] - truth).sel(body="front")).max() > 0.05 * np.abs(truth).max()
    assert motion["position"].identical(simulation["position"])


def test_film_alone_tells_of_accelerations_through_the_smoother(workshop, model, recorded, misfit, simulated):
    run = recorded(model)
    del run["accelerometer"]
    one = misfit(model, run=run)
    simulation = one.predictor.motion("run", one.values(one.start()))
    motion = recorded_motion(one, "run", simulation, workshop.smoother)
    truth = simulated(model, 1.0, simulation["time"].values)
    assert np.sqrt((((motion["acceleration"] - truth["acceleration"]).sel(body="front")) ** 2).mean()) < 15.0


def test_a_biased_accelerometer_asks_for_no_more_than_its_bias(workshop, model, recorded, misfit):
    """Its integral is centimetres off at the end, where the joint unloads along a meganewton per metre."""
    biased = recorded(model, noise=0.0, accelerometer=lambda group: group.assign(acceleration=group["acceleration"] + 5.0))
    one = misfit(model, run=biased)
    simulation = one.predictor.motion("run", one.values(one.start()))
    motion = recorded_motion(one, "run", simulation, workshop.smoother)
    asked = on_joint(missing_force(model, workshop.laws, motion), ("wall", "front"), np.array([[-1.0]]))
    assert np.abs(asked) == pytest.approx(5.0 * model.body("front").mass.value, rel=0.02)


def test_bins_are_means_with_their_deviations():
    times = np.arange(4000) * 1e-5
    values = 5.0 + np.random.default_rng(0).normal(0.0, 2.0, times.size)
    instants, means, deviations = binned(times, values)
    assert len(instants) == 40
    assert means == pytest.approx(values.reshape(40, 100).mean(axis=1))
    assert deviations == pytest.approx(0.2, rel=0.4)
    assert np.std(means) == pytest.approx(0.2, rel=0.4)
