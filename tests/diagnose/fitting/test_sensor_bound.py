"""What an error of one sensor can explain at most."""

import pytest

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.fitting.sensor_bound import sensor_of, that_may_reach


@pytest.fixture
def base(workshop, misfit, model, recorded):
    """The best fit to a film that is right and an accelerometer that reads a tenth too much."""

    def too_much(dataset):
        return dataset.assign(acceleration=1.1 * dataset["acceleration"])

    given = misfit(model, run=recorded(model, accelerometer=too_much))
    return begin(workshop.identifier, given).advance(40)


def test_only_claims_about_a_sensor_that_leaves_enough_may_explain_it(workshop, base):
    fitted = base.fitted()
    readings = [(p, {}) for p in propose_all(workshop, fitted) if p.physics in ("bias", "gain_error") and sensor_of(p)]
    assert {sensor_of(p)[0] for p, _ in readings} == {"film", "accelerometer"}
    gain = next(p for p, _ in readings if p.physics == "gain_error" and p.location["instrument"] == "accelerometer")
    right = begin(workshop.identifier, workshop.misfit(fitted, gain.model)).advance(40)
    cost = base.state.cost
    drop = cost - right.state.cost
    assert drop > 20.0
    kept = that_may_reach(workshop.identifier, fitted, readings, cost - 0.9 * drop)
    assert {sensor_of(p)[0] for p, _ in kept} == {"accelerometer"}
    assert that_may_reach(workshop.identifier, fitted, readings, cost - 1.5 * drop) == []


def test_a_noise_that_nobody_states_may_be_as_small_as_one_likes(workshop, misfit, model, recorded):
    """The level of a filtered channel is estimated by what a wrong model leaves: that is no floor."""

    def of_unknown_noise(dataset):
        dataset = dataset.assign(acceleration=1.1 * dataset["acceleration"]).drop_vars("acceleration_std")
        return dataset.assign_attrs(channel_frequency_class=600)

    search = begin(workshop.identifier, misfit(model, run=recorded(model, accelerometer=of_unknown_noise))).advance(40)
    base = search.fitted().reweighted(search.point)
    gain = next(p for p in propose_all(workshop, base) if p.physics == "gain_error" and p.location["instrument"] != "film")
    right = begin(workshop.identifier, workshop.misfit(base, gain.model)).advance(40)
    cost = begin(workshop.identifier, base).state.cost
    drop = cost - right.state.cost
    assert drop > 20.0
    assert that_may_reach(workshop.identifier, base, [(gain, {})], cost - 0.9 * drop)


def test_without_a_sensor_nothing_of_it_counts(base):
    misfit = base.fitted()
    blind = misfit.without_sensor("accelerometer", "front_sensor")
    sums = dict(zip((one.name for one in blind.channels), blind.channel_sums(blind.residual(blind.start())), strict=True))
    assert sums["run/accelerometer/front_sensor"] == 0.0
    assert sums["run/film/front_marker"] > 0.0
    film = next(one for one in misfit.channels if one.instrument == "film")
    assert blind.independent_samples == film.independent_samples
    assert misfit.without_sensor("film", "another").independent_samples == misfit.independent_samples
    assert film in blind.channels
