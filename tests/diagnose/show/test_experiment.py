"""Which experiment would separate two rivals."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.diagnose.show.answer import _seen_alike
from crashkit.diagnose.show.experiment import Duel, experiment
from crashkit.model import Body, Joint, Parameter
from crashkit.model.edit import with_joint

BRAKE = {"friction_force": Parameter(5e3, fixed=True), "slip_rate": Parameter(0.05, fixed=True)}


@pytest.fixture
def rubbing(model):
    """A friction in the joint to the wall."""
    return with_joint(model, Joint("rub", ("wall", "front"), "coulomb", BRAKE))


@pytest.fixture
def braked(model):
    """The same on the ground."""
    ground = Body("ground", (100.0,), (0.0,), fixed=True)
    return with_joint(evolve(model, bodies=(*model.bodies, ground)), Joint("brake", ("ground", "front"), "coulomb", BRAKE))


def separated(sentence):
    """The sigma of the experiment that a sentence recommends."""
    return float(sentence.split(";")[0].rsplit(": ", 1)[1].split()[0])


def test_a_rival_that_differs_at_higher_speed_is_told_apart_there(misfit, model, recorded):
    run = recorded(model, 1.0)
    best = misfit(model, run=run)
    rival = misfit(model.with_values({"joint.first.densification_stiffness": 1.3e5}), run=run)
    sentence = experiment(best, rival, "bottoming at joint first", model.bodies)
    assert sentence.startswith("the same test at 12.0 m/s would separate this from bottoming at joint first: ")
    first, second = (one.at_speed(1.2).residual(one.start()) for one in (best, rival))
    assert 3.0 < separated(sentence) < np.linalg.norm(first - second)  # other values of the rival take up a part


def test_sigma_is_that_of_a_linear_model(misfit, model, recorded):
    """d' (1 + J A^-1 J')^-1 d, as it stands in every textbook."""
    random = np.random.default_rng(0)
    one = misfit(model, run=recorded(model))
    jacobian, known, difference = random.normal(size=(30, 4)), random.normal(size=(50, 4)), random.normal(size=30)
    told = Duel(one, one, known.T @ known).sigma(difference, jacobian)
    spread = np.eye(30) + jacobian @ np.linalg.inv(known.T @ known) @ jacobian.T
    assert told == pytest.approx(np.sqrt(difference @ np.linalg.solve(spread, difference)))


def test_what_the_rivals_values_can_take_up_separates_nothing(misfit, model, recorded):
    one = misfit(model, run=recorded(model))
    jacobian = np.random.default_rng(0).normal(size=(30, 4))
    assert Duel(one, one, np.zeros((4, 4))).sigma(jacobian @ np.ones(4), jacobian) == pytest.approx(0.0, abs=1e-5)


def test_rivals_that_predict_alike_are_hardly_told_apart(misfit, model, recorded):
    one = misfit(model, run=recorded(model))
    assert experiment(one, one, "its twin", model.bodies) == (
        "no test that was tried would separate this from its twin: the same test at 12.0 m/s, more mass and a further "
        "instrument give at most 0 sigma"
    )


def test_a_load_cell_separates_what_the_wall_feels_from_what_the_ground_feels(misfit, model, rubbing, braked, recorded):
    run = recorded(rubbing)
    sentence = experiment(misfit(rubbing, run=run), misfit(braked, run=run), "ground_friction at body front", model.bodies)
    assert sentence.startswith("a load cell on wall would separate this from ground_friction at body front: ")
    assert sentence.endswith("; the same test at 12.0 m/s hardly: 0 sigma") and separated(sentence) > 10.0


def test_an_instrument_that_is_there_is_not_asked_for(misfit, model, rubbing, braked, recorded, simulated):
    force = simulated(rubbing)["contact_force"].sel(body=["wall"]).transpose("time", "body", "axis").values
    cell = xr.Dataset(
        {
            "force": (("time", "sensor", "axis"), force, {"units": "N"}),
            "sensor_body": ("sensor", ["wall"]),
            "force_std": ("sensor", [2e3], {"units": "N"}),
        },
        coords={"time": ("time", np.arange(1201) * 2.5e-4, {"units": "s"}), "sensor": ["plate"], "axis": ["x"]},
        attrs={"observer": "load_cell", "channel_frequency_class": 0},
    )
    run = recorded(rubbing).assign({"cell": xr.DataTree(cell)})
    sentence = experiment(misfit(rubbing, run=run), misfit(braked, run=run), "ground_friction at body front", model.bodies)
    assert "load cell" not in sentence


def test_nothing_is_asked_for_where_nothing_moves(misfit, model, recorded):
    run = recorded(model)
    still = run["initial"].to_dataset(inherit=False)
    one = misfit(model, run=run.assign({"initial": xr.DataTree(still.assign(velocity=0.0 * still["velocity"]))}))
    assert experiment(one, one, "its twin", model.bodies) == ""


@pytest.mark.parametrize("fuller", [0, 1])
def test_rivals_that_were_fitted_to_other_instruments_are_compared_on_all_of_them(workshop, misfit, model, recorded, fuller):
    """An accelerometer that was set aside for the one is believed for the other."""
    whole = recorded(model)
    seen = [{"run": whole.drop_nodes("accelerometer")}, {"run": whole.drop_nodes("accelerometer")}]
    seen[fuller] = {"run": whole}
    stiffer = model.with_values({"joint.first.densification_stiffness": 1.3e5})
    best, rival = _seen_alike(workshop, misfit(model, **seen[0]), misfit(stiffer, **seen[1]))
    assert {len(best.channels), len(rival.channels)} == {2}
    assert (best.model, rival.model) == (model, stiffer)
    assert experiment(best, rival, "bottoming at joint first", model.bodies).startswith("the same test at 12.0 m/s")
