"""Recordings are thinned as far as a search can bear, and no further."""

import numpy as np
import pytest
import xarray as xr

from crashkit.data.channel_filter import filter_channel
from crashkit.diagnose.fitting.thinning import LITTLE, thinned_by
from crashkit.errors import SimulationError
from crashkit.mechanics import Simulator
from crashkit.misfit.thin import thinned
from crashkit.testing import toys

TIMES = np.arange(3001) * 1e-4


@pytest.fixture(scope="module")
def felt_by(workshop):
    """What film and an accelerometer of a class at 10 kHz record of a toy whose stiffnesses are multiplied."""

    def record(stiffer, cfc):
        model = toys.one_degree()
        model = model.at({p: stiffer * v.value for p, v in model.parameters().items() if p.endswith("stiffness")})
        motion = Simulator(model, workshop.laws, workshop.engine).run(TIMES, initial=toys.initial_state(model, 1.0), step=1e-4)
        run = toys.recording(motion)
        felt = run["accelerometer"].to_dataset(inherit=False)
        if cfc:
            filtered = filter_channel(felt["acceleration"].values, TIMES, cfc, before=0.0)
            felt = felt.assign(acceleration=felt["acceleration"].copy(data=filtered)).assign_attrs(channel_frequency_class=cfc)
        return model, {"run": run.assign(accelerometer=xr.DataTree(felt))}

    return record


@pytest.mark.parametrize("cfc", [0, 180, 1000])
def test_what_a_fitted_model_explains_is_thinned_without_error(workshop, felt_by, cfc):
    """Corners, and what a filter makes of them at a low rate, are not taken for physics."""
    model, recordings = felt_by(30.0, cfc)
    quantities = {name: observer.quantity for name, observer in workshop.observers.items()}
    left = {}
    for name, thin in (
        ("as it is", {run: thinned(recording, quantities) for run, recording in recordings.items()}),
        ("in the light of the model", thinned_by(workshop, recordings, model)),
    ):
        misfit = workshop.first_misfit(model, thin)
        left[name] = np.abs(misfit.residual(misfit.start())).max()
    assert left["as it is"] > 0.1
    assert left["in the light of the model"] < 0.02


@pytest.mark.parametrize(("stiffer", "outruns"), [(1.0, False), (3000.0, True)])
def test_a_structure_that_outruns_the_rate_of_a_filter_is_given_a_higher_one(workshop, felt_by, stiffer, outruns):
    """At 2000 samples a second a spike of a millisecond is a sample or two, and its filter sees another one."""
    model, recordings = felt_by(stiffer, 60)
    thin = thinned_by(workshop, recordings, model)["run"]["accelerometer"].sizes["time"]
    assert (thin > 601) is outruns and thin <= len(TIMES)


def test_a_model_a_little_off_then_sees_what_it_would_see_in_all_samples(workshop, felt_by):
    model, recordings = felt_by(3000.0, 60)
    path = "joint.first.elastic_stiffness"
    off = {path: 1.05 * model.parameters()[path].value}
    sizes = []
    for runs in (recordings, thinned_by(workshop, recordings, model)):
        misfit = workshop.first_misfit(model, runs).with_values(off)
        sizes.append(np.sqrt(misfit.channel_sums(misfit.residual(misfit.start()))[1] / misfit.channels[1].independent_samples))
    assert sizes[1] == pytest.approx(sizes[0], abs=2.0 * LITTLE)


def test_of_a_model_that_cannot_be_simulated_nothing_is_expected(workshop, felt_by, monkeypatch):
    model, recordings = felt_by(1.0, 60)
    plain = {"run": thinned(recordings["run"], {name: o.quantity for name, o in workshop.observers.items()})}

    def blow_up(*_):
        raise SimulationError("it does not move")

    monkeypatch.setattr("crashkit.misfit.predictor.Predictor.predict_at", blow_up)
    assert thinned_by(workshop, recordings, model)["run"].identical(plain["run"])
