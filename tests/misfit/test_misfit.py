"""Residuals in measurement space: what they are, and what follows from them."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve
from scipy.signal import butter, filtfilt

from crashkit.data.channel_filter import DESIGN_FREQUENCY, filter_channel
from crashkit.errors import CrashkitError
from crashkit.misfit import predictor
from crashkit.misfit.channel import reweighted
from crashkit.misfit.predictor import instrument_errors
from crashkit.misfit.variables import NO_PRIOR, Prior, SearchVariables
from crashkit.model import Body, Joint, KnownSum, Parameter
from crashkit.model.edit import with_body, with_joint
from crashkit.testing import toys

FILM_STD, ACCELEROMETER_STD = 1e-3, 1.0
"""As the toys state them."""


def shifted(variable, by):
    return lambda dataset: dataset.assign({variable: dataset[variable] + by})


def as_filtered(dataset):
    dataset.attrs["channel_frequency_class"] = 180
    return dataset


def test_a_model_leaves_nothing_of_its_own_recording(misfit, model, recorded):
    own = misfit(model, run=recorded(model))
    assert np.abs(own.residual(own.start())).max() < 1e-6


def test_a_residual_is_recorded_minus_predicted_over_std(misfit, model, recorded, changed):
    run = changed(recorded(model), "film", shifted("position", 3e-3))
    run = changed(run, "accelerometer", shifted("acceleration", -2.0))
    one = misfit(model, run=run)
    residual = one.residual(one.start())
    film, accelerometer = np.split(residual, 2)
    assert film == pytest.approx(3e-3 / FILM_STD, abs=1e-6)
    assert accelerometer == pytest.approx(-2.0 / ACCELEROMETER_STD, abs=1e-6)


def test_a_filtered_channel_is_predicted_filtered_and_weighs_less(misfit, model, recorded, changed, registry, simulated):
    run = changed(recorded(model, interval=1e-4), "accelerometer", as_filtered)
    instrument = run["accelerometer"].to_dataset(inherit=False)
    motion = simulated(model, instrument["time"].values)
    read = registry.observers["accelerometer"]().predict(motion, instrument)["acceleration"]
    run = changed(run, "accelerometer", lambda dataset: dataset.assign(acceleration=read + 4.0))
    one = misfit(model, run=run)
    channel = one.channels[1]
    residual = one.residual(one.start())[-instrument.sizes["time"] :]
    assert channel.noise.correlation == pytest.approx(16.0, rel=0.01)
    assert residual == pytest.approx(4.0 / np.sqrt(channel.noise.correlation), abs=1e-6)
    assert channel.independent_samples == pytest.approx(channel.samples / channel.noise.correlation)


@pytest.mark.parametrize("filters", [(), (as_filtered,)], ids=["as sampled", "filtered"])
def test_the_jacobian_is_that_of_central_differences(misfit, model, recorded, changed, with_errors, filters):
    run = recorded(model, interval=2e-4)
    for change in filters:
        run = changed(run, "accelerometer", change)
    watched = with_errors(model, "film", "front_marker", gain=1.01, bias=2e-3)
    watched = with_errors(watched, "accelerometer", "front_sensor", gain=0.97, bias=3.0)
    one = misfit(watched, run=run)
    assert_jacobian(one, 1e-6, 2e-5)


@pytest.mark.parametrize("instrument", ["film", "accelerometer"])
def test_the_jacobian_to_a_clock_is_that_of_central_differences(misfit, model, recorded, changed, with_errors, instrument):
    """Over steps of one sample: between samples the motion is interpolated, and its rate is that of a whole sample."""
    interval = 2e-4
    run = changed(recorded(model, interval=interval), "accelerometer", as_filtered)
    one = misfit(with_errors(model, instrument, "", clock_offset=2.0 * interval), run=run)
    assert_jacobian(one.with_values({}, dict.fromkeys(one.names[:-1], False)), interval / 2, 0.02)


WRONG = {
    "film": {"gain": 1.02, "bias": 2e-3, "rocking_share": 0.3, "rocking_frequency": 5.0, "rocking_damping": 0.2},
    "accelerometer": {"gain": 0.9, "lean": 0.2, "cubic": 1e-6, "hysteresis": 2.0, "saturation_knee": 30.0, "zero_shift": 4.0},
}


def from_before_contact(dataset):
    return dataset.assign_coords(time=dataset["time"] - 0.02)


@pytest.mark.parametrize("filters", [(), (as_filtered,)], ids=["as sampled", "filtered"])
@pytest.mark.parametrize("instrument", WRONG)
def test_what_is_read_without_a_motion_is_what_the_observer_says_of_it(
    misfit, model, recorded, changed, with_errors, filters, instrument, monkeypatch
):
    run = changed(recorded(model), instrument, from_before_contact)
    for change in filters:
        run = changed(run, "accelerometer", change)
    sensor = run[instrument][{"film": "marker", "accelerometer": "sensor"}[instrument]].values[0]
    wrong = with_errors(model, instrument, str(sensor), **WRONG[instrument])
    wrong = with_errors(wrong, instrument, "", clock_offset=3e-4, clock_rate=-1e-3)
    told = []
    for _ in range(2):
        one = misfit(wrong, run=run).with_step(2e-5)
        told.append((one.residual(one.start()), *one.residual_and_jacobian(one.start())))
        monkeypatch.setattr(predictor, "readout_of", lambda *_: None)
    (*without, slopes), (*with_motion, others) = told
    for one, other in zip(without, with_motion, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-6 * np.abs(other).max())
    # To a clock, which differentiates what was read, they differ by 1e-4 of the largest, however short the steps.
    np.testing.assert_allclose(slopes, others, rtol=1e-6, atol=3e-4 * np.abs(others).max())


def held_by_the_ground(model):
    """The wall can move, and a spring holds it to the ground behind it."""
    wall = evolve(model.body("wall"), fixed=False, mass=Parameter(500.0, 50.0, 5e3))
    ground = Body("ground", (5.0,), (0.0,), fixed=True)
    held = evolve(model.joint("first"), name="held", bodies=("ground", "wall"), support=True)
    return with_joint(with_body(evolve(model, bodies=(wall, *model.bodies[1:])), ground), held)


def with_load_cell(run):
    """On the wall."""
    times = np.arange(301) * 1e-3
    force = xr.Variable(("time", "sensor", "axis"), np.zeros((len(times), 1, 1)), {"units": "N"})
    cell = xr.Dataset(
        {"force": force, "sensor_body": ("sensor", ["wall"]), "force_std": ("sensor", [2e3], {"units": "N"})},
        {"time": ("time", times, {"units": "s"}), "sensor": ["plate"], "axis": ["x"]},
        {"observer": "load_cell", "channel_frequency_class": 0},
    )
    return run.assign({"cell": xr.DataTree(cell)})


def test_a_load_cell_on_a_held_obstacle_is_read_without_a_motion(misfit, model, recorded, monkeypatch):
    """It feels what the mass exerts on the wall, and not what holds that."""
    held = held_by_the_ground(model)
    run = with_load_cell(recorded(held))
    fast = misfit(held, run=run).with_step(2e-5)
    residual, jacobian = fast.residual_and_jacobian(fast.start())
    felt = -2e3 * residual[-301:]
    mass, deceleration = held.body("front").mass.value, run["accelerometer"]["acceleration"].sel(sensor="front_sensor").values
    np.testing.assert_allclose(felt, -mass * deceleration.ravel(), rtol=1e-3, atol=1e-3 * np.abs(felt).max())
    monkeypatch.setattr(predictor, "readout_of", lambda *_: None)
    slow = misfit(held, run=run).with_step(2e-5)
    others, slopes = slow.residual_and_jacobian(slow.start())
    np.testing.assert_allclose(residual, others, rtol=1e-6, atol=1e-6 * np.abs(others).max())
    np.testing.assert_allclose(jacobian, slopes, rtol=1e-6, atol=1e-6 * np.abs(slopes).max())


def test_a_load_cell_is_read_between_steps(misfit, model, recorded, monkeypatch):
    between = misfit(model, run=with_load_cell(recorded(model))).with_step(7e-4)  # no divisor of the time between samples
    told = between.residual_and_jacobian(between.start())
    assert between.predictor.longest_step > 0.2
    monkeypatch.setattr(predictor.Predictor, "_steps_end_at_all", True)
    exact = misfit(model, run=with_load_cell(recorded(model))).with_step(2e-5)
    for one, other in zip(told, exact.residual_and_jacobian(exact.start()), strict=True):
        np.testing.assert_allclose(one[-301:], other[-301:], rtol=1e-3, atol=1e-4 * np.abs(other[-301:]).max())


def assert_jacobian(problem, step, accuracy):
    point = problem.start()
    _, jacobian = problem.residual_and_jacobian(point)
    for column, name in enumerate(problem.names):
        move = np.zeros(len(point))
        move[column] = step * max(1.0, abs(point[column])) if step < 1e-5 else step
        difference = (problem.residual(point + move) - problem.residual(point - move)) / (2.0 * move[column])
        error = np.linalg.norm(jacobian[:, column] - difference) / np.linalg.norm(difference)
        assert error < accuracy, f"{name}: {error:g}"


def test_hidden_frames_are_left_out(misfit, model, recorded, changed):
    def hide(dataset):
        dataset["position"][10:40] = np.nan
        return dataset

    whole, gappy = (misfit(model, run=run) for run in (recorded(model), changed(recorded(model), "film", hide)))
    residual, jacobian = gappy.residual_and_jacobian(gappy.start())
    assert len(residual) == len(jacobian) == len(whole.residual(whole.start())) - 30
    assert np.isfinite(residual).all() and np.isfinite(jacobian).all()
    assert gappy.channels[0].samples == whole.channels[0].samples - 30


def test_search_variables_are_logarithms_of_what_must_be_positive(misfit, model, recorded, with_errors):
    one = misfit(with_errors(model, "film", "front_marker", bias=-2e-3), run=recorded(model))
    point = one.start()
    assert point[:-1] == pytest.approx(np.log([p.value for p in list(model.free_parameters().values())]))
    assert point[-1] == -2e-3
    assert one.parameters(one.scaled(np.abs(one.parameters(point)))) == pytest.approx(np.abs(one.parameters(point)))
    assert list(one.values(point)) == list(one.names)


def test_a_trusted_deviance_is_chi_squared(misfit, model, recorded, changed):
    one = misfit(model, run=changed(recorded(model), "film", shifted("position", 2e-3)))
    residual = one.residual(one.start())
    assert one.deviance(residual) == pytest.approx(float(residual @ residual))
    assert one.deviance(residual) == pytest.approx(4.0 * one.channels[0].samples, rel=1e-6)


def without_std(dataset):
    return as_filtered(dataset.drop_vars("acceleration_std"))


def open_level(misfit, model, recorded, changed, by=50.0):
    """Filtered, with a level that nobody stated; the model is off by a constant."""
    run = changed(recorded(model, interval=1e-4), "accelerometer", without_std)
    noise = np.random.default_rng(3).normal(0.0, 20.0, run["accelerometer"]["acceleration"].shape)
    return misfit(model, run=changed(run, "accelerometer", shifted("acceleration", noise + by)))


def test_a_level_that_is_only_estimated_counts_by_the_size_of_what_is_left(misfit, model, recorded, changed):
    one = open_level(misfit, model, recorded, changed)
    film, accelerometer = one.channel_sums(one.residual(one.start()))
    count, std = one.channels[1].independent_samples, one.channels[1].noise.std
    assert not one.channels[1].noise.trusted
    assert one.deviance(one.residual(one.start())) == pytest.approx(film + count * np.log(accelerometer / count * std**2))


def test_reweighted_levels_are_what_the_model_leaves(misfit, model, recorded, changed):
    one = open_level(misfit, model, recorded, changed)
    again = one.reweighted(one.start())
    sums = again.channel_sums(again.residual(again.start()))
    assert sums[1] == pytest.approx(again.channels[1].independent_samples)
    assert again.channels[0].noise == one.channels[0].noise


def test_a_floor_is_no_higher_than_a_share_of_what_a_model_leaves(misfit, model, recorded, changed):
    """The readings alone may say far too much: below the corner of a low filter a structure moves."""
    group = open_level(misfit, model, recorded, changed).groups[1]
    given, peak = group.channels[0].noise, float(np.nanmax(np.abs(group.recorded[:, 0])))
    left = np.random.default_rng(4).normal(0.0, 0.1 * given.least, len(group.times))
    noise = reweighted(group, 0, left).noise
    assert noise.std == pytest.approx(float(np.std(left)), rel=0.05)
    assert noise.least == pytest.approx(max(0.1 * noise.std, 1e-3 * peak), rel=0.05)
    assert reweighted(group, 0, np.zeros(len(left))).noise.std == pytest.approx(min(given.least, 1e-3 * peak))


def test_ends_that_a_filter_has_made_up_are_no_readings(misfit, model, recorded, changed):
    """A filter that mirrors the ends of a record, and the same readings through one that was told of the rest before."""
    plain = recorded(model)
    times = plain["accelerometer"]["time"].values

    def filtered(function):
        def change(dataset):
            felt = dataset.assign(acceleration=dataset["acceleration"].copy(data=function(dataset["acceleration"].values)))
            felt["acceleration_std"][:] = 0.02
            return felt.assign_attrs(channel_frequency_class=60)

        return misfit(model, run=changed(plain, "accelerometer", change))

    told = filtered(lambda samples: filter_channel(samples, times, 60, before=0.0))
    mirrored = filtered(lambda samples: filtfilt(*butter(2, DESIGN_FREQUENCY * 60, fs=1000.0), samples, axis=0))
    believed = np.isfinite(mirrored.groups[1].recorded[:, 0])
    assert np.isfinite(told.groups[1].recorded).all()
    assert times[believed][[0, -1]] == pytest.approx([0.011, 0.289], abs=1e-9)
    assert mirrored.groups[1].channels[0].samples == np.count_nonzero(believed) == 279
    assert all(np.abs(one.residual(one.start())).max() < 0.1 for one in (told, mirrored))


def test_levels_can_be_set_by_channel(misfit, model, recorded, changed):
    one = misfit(model, run=changed(recorded(model), "film", shifted("position", 2e-3)))
    level = evolve(one.channels[0].noise, std=2e-3, least=1e-3)
    wider = one.with_levels({("film", "front_marker", "x"): level})
    assert wider.channels[0].noise.least == 1e-3
    assert wider.residual(one.start())[0] == pytest.approx(1.0, abs=1e-6)
    assert wider.channels[1] == one.channels[1]


def test_some_of_the_runs_leave_their_part_of_the_residual(misfit, model, recorded):
    off = model.with_values({"joint.first.crush_force": 2.5e4})
    both = misfit(off, slow=recorded(model, 0.8), fast=recorded(model, 1.2))
    fast = both.with_recordings(("fast",))
    residual = both.residual(both.start())
    assert {channel.run for channel in fast.channels} == {"fast"}
    assert fast.residual(fast.start()) == pytest.approx(residual[len(residual) // 2 :])


def test_a_faster_test_is_the_simulation_at_that_speed(misfit, model, recorded):
    one = misfit(model, run=recorded(model, 1.0))
    faster, recorded_so = one.at_speed(1.2), misfit(model, run=recorded(model, 1.2))
    ours, theirs = (m.predictor.predict(m.values(m.start())) for m in (faster, recorded_so))
    for mine, other in zip(ours, theirs, strict=True):
        assert mine.samples == pytest.approx(other.samples, abs=1e-6)


def test_values_and_freedom_can_be_changed_without_reading_the_recordings_again(misfit, model, recorded):
    one = misfit(model, run=recorded(model))
    held = one.with_values({"joint.first.crush_force": 2e4}, {"joint.first.crush_force": False})
    assert held.names == tuple(name for name in one.names if name != "joint.first.crush_force")
    assert held.model.parameters()["joint.first.crush_force"].value == 2e4
    assert np.abs(held.residual(held.start())).max() > 1.0


def test_a_load_that_no_recording_knows_starts_with_its_carrier(misfit, model, recorded):
    load = Body("load", (0.0,), (0.0,), Parameter(50.0, fixed=True), carrier="front")
    values = {
        "stiffness": Parameter(1e4, fixed=True),
        "damping": Parameter(0.0, fixed=True),
        "slack": Parameter(0.0, fixed=True),
    }
    loaded = with_joint(with_body(model, load), Joint("hold", ("load", "front"), "tie", values))
    motion = misfit(loaded, run=recorded(model, 0.7)).predictor.motion("run", {})
    start = motion.isel(time=0)
    assert float(start["position"].sel(body="load", axis="x")) == -toys.LENGTH
    assert float(start["velocity"].sel(body="load", axis="x")) == pytest.approx(0.7 * toys.SPEED)


def test_a_sensor_on_a_body_that_the_model_lacks_is_named(misfit, model, recorded, changed):
    run = changed(recorded(model), "accelerometer", lambda dataset: dataset.assign(sensor_body=("sensor", ["engine"])))
    with pytest.raises(
        CrashkitError, match=r"^run: accelerometer/sensor_body: expected a body of the model \(front, wall\), found engine$"
    ):
        misfit(model, run=run)


def test_an_observer_that_is_not_installed_is_named(misfit, model, recorded, changed, registry):
    run = changed(recorded(model), "film", lambda dataset: dataset.assign_attrs(observer="radar"))
    known = ", ".join(sorted(registry.observers))
    with pytest.raises(CrashkitError, match=rf"^run: film: expected an installed observer \({known}\), found radar$"):
        misfit(model, run=run)


def test_instrument_errors_are_told_by_instrument_and_sensor(model, with_errors):
    watched = with_errors(model, "film", "front_marker", bias=1e-3)
    watched = with_errors(watched, "film", "", clock_offset=2e-3)
    path = "instrument.film.front_marker.bias"
    assert instrument_errors(watched, {path: 5e-3}) == {"film": {"front_marker": {"bias": 5e-3}, "": {"clock_offset": 2e-3}}}


def test_the_errors_of_a_sensor_touch_no_other(misfit, simulated, with_errors):
    twin = toys.two_degrees()
    recording = toys.recording(simulated(twin, np.linspace(0.0, 0.3, 301)))
    one = misfit(with_errors(twin, "accelerometer", "rear_sensor", gain=1.1), run=recording)
    sums = one.channel_sums(one.residual(one.start()))
    names = [f"{c.instrument}/{c.sensor}" for c in one.channels]
    assert [name for name, total in zip(names, sums, strict=True) if total > 1.0] == ["accelerometer/rear_sensor"]


def test_a_late_clock_of_the_film_reads_the_motion_of_earlier(misfit, model, recorded, with_errors):
    late = misfit(with_errors(model, "film", "", clock_offset=2e-3), run=recorded(model)).predictor
    samples = late.predict({name: p.value for name, p in late.model.free_parameters().items()})[0].samples[:, 0]
    true = recorded(model)["film"]["position"].values[:, 0, 0]
    assert samples[2:] == pytest.approx(true[:-2], abs=1e-7)


def test_an_uninformative_model_parameter_has_no_derivative(misfit, model, recorded):
    free = model.with_parameters({"joint.first.clearance": Parameter(0.0, 0.0, 1.0)})
    early = misfit(free, run=recorded(model, end=0.01))
    _, jacobian = early.residual_and_jacobian(early.start())
    unseen = early.names.index("joint.first.densification_stiffness")
    assert np.all(jacobian[:, unseen] == 0.0)
    assert np.abs(jacobian[:, early.names.index("joint.first.clearance")]).max() > 0.0


def departure(misfit, point):
    """From what is known beforehand, as chi squared."""
    return np.sum(misfit.belief(point)[0] ** 2)


def test_what_is_known_beforehand_pulls_by_the_logarithm(misfit, model, recorded):
    own = misfit(model, run=recorded(model)).with_prior(0.2)
    path = "joint.first.crush_force"
    point = own.start()
    assert departure(own, point) == 0.0
    point[own.names.index(path)] += np.log(1.5)
    assert departure(own, point) == pytest.approx((np.log(1.5) / 0.2) ** 2)
    plain = misfit(model, run=recorded(model))
    gained = own.deviance(own.residual(point)) - plain.deviance(plain.residual(point))
    assert gained == pytest.approx(departure(own, point))
    assert_jacobian(own.with_values({path: 1.3 * model.parameters()[path].value}), 1e-6, 2e-5)
    assert own.with_values({path: 1.3}).prior == own.prior


def test_what_is_known_beforehand_is_not_sought_far_away(misfit, model, recorded):
    path = "joint.first.crush_force"
    wide = model.with_parameters({path: Parameter(2.0, 1e-3, 1e9), "joint.first.clearance": Parameter(0.01, 0.0, 1.0)})
    own = misfit(wide, run=recorded(model)).with_prior(0.3)
    for one in (own, own.with_values({path: 3.0})):
        lower, upper = (one.values(bound) for bound in one.bounds())
        assert (lower[path], upper[path]) == pytest.approx((2.0 * np.exp(-3.0), 2.0 * np.exp(3.0)))
        assert (lower["joint.first.clearance"], upper["joint.first.clearance"]) == (0.0, 1.0)
    narrow = misfit(model.with_parameters({path: Parameter(2.0, 1.0, 3.0)}), run=recorded(model)).with_prior(0.3)
    assert [narrow.values(bound)[path] for bound in narrow.bounds()] == pytest.approx([1.0, 3.0])


def test_a_number_that_is_not_searched_in_its_logarithm_is_known_relative_to_itself(misfit, model, recorded):
    """Else one that the recordings do not see could go anywhere; of a zero nothing is known."""
    gap, rate = "joint.first.clearance", "joint.first.rate_coefficient"
    free = model.with_parameters({gap: Parameter(0.01, 0.0, 1.0), rate: Parameter(0.0, -1.0, 1.0)})
    own = misfit(free, run=recorded(model)).with_prior(0.2)
    point = own.start()
    assert departure(own, point) == 0.0
    point[own.names.index(gap)] += 0.003
    point[own.names.index(rate)] += 0.5
    assert departure(own, point) == pytest.approx(2.25)
    assert_jacobian(own.with_values({gap: 0.013}), 1e-6, 2e-5)


@pytest.mark.parametrize(
    ("off", "count", "is_strained"), [(2.9, 1, False), (3.1, 1, True), (1.9, 5, False), (2.1, 2, False), (2.2, 2, True)]
)
def test_numbers_are_strained_where_some_are_far_off_and_not_where_all_are_a_little(off, count, is_strained):
    """Springs that are given 40 % off leave a chi squared of 14 where there are a dozen, and none of them hides anything."""
    free = {f"joint.first.{number}": Parameter(1.0, 0.01, 100.0) for number in range(5)}
    known = SearchVariables(free, Prior(dict.fromkeys(free, 1.0), 0.3))
    point = known.start()
    point[:count] += 0.3 * off
    assert known.is_strained(point) is is_strained
    assert not SearchVariables(free, NO_PRIOR).is_strained(point)


def test_a_size_expected_of_a_parameter_pulls_it_towards_zero(misfit, model, recorded):
    path = "joint.first.clearance"
    expected = misfit(model.with_parameters({path: Parameter(0.01, 0.0, 1.0, size=0.004)}), run=recorded(model))
    point = expected.start()
    assert departure(expected, point) == pytest.approx(6.25)
    residual, jacobian = expected.residual_and_jacobian(point)
    assert len(residual) == len(expected.discrepancy(point)) + 1
    assert residual[-1] == pytest.approx(2.5)
    assert jacobian[-1] == pytest.approx(np.where([name == path for name in expected.names], 250.0, 0.0))


def test_a_test_at_another_speed_knows_nothing_beforehand(misfit, model, recorded):
    own = misfit(model, run=recorded(model)).with_prior(0.2).at_speed(1.2)
    assert len(own.residual(own.start())) == sum(channel.samples for channel in own.channels)


def test_a_line_is_compared_with_what_was_recorded_along_it(misfit, model, recorded, changed):
    def across(dataset):
        other = dataset.assign_coords(axis=["z"])
        return xr.concat([dataset, other], "axis", data_vars="minimal").assign_attrs(dataset.attrs)

    run = recorded(model)
    wide = changed(changed(run, "film", across), "accelerometer", across)
    assert misfit(model, run=wide).start() == pytest.approx(misfit(model, run=run).start())
    one, other = misfit(model, run=wide), misfit(model, run=run)
    assert one.residual(one.start()) == pytest.approx(other.residual(other.start()), abs=1e-9)


def test_an_instrument_across_the_line_of_the_model_is_named(misfit, model, recorded, changed):
    run = changed(recorded(model), "film", lambda dataset: dataset.assign_coords(axis=["z"]))
    with pytest.raises(CrashkitError, match="run: film/axis: expected the model's x, found z"):
        misfit(model, run=run)


def test_an_error_of_one_axis_is_that_of_a_sensor_which_has_no_other(misfit, model, recorded, with_errors):
    """Nothing where it names an axis that the sensor does not have."""
    run = recorded(model, interval=2e-4)
    left = {}
    for sensor in ("front_sensor", "front_sensor/x", "front_sensor/y"):
        own = misfit(with_errors(model, "accelerometer", sensor, bias=3.0), run=run)
        left[sensor] = own.residual_and_jacobian(own.start())
    for whole, x, y in zip(*left.values(), strict=True):
        assert np.array_equal(whole, x)
        assert not np.array_equal(whole, y)
    assert np.abs(left["front_sensor/y"][0]).max() < 1e-6


PARTS = ("joint.first.crush_force", "joint.first.elastic_stiffness")


@pytest.mark.parametrize("free", [PARTS, PARTS[:1]])
def test_a_sum_that_is_known_pulls_its_numbers_to_it_of_which_some_may_be_fixed(misfit, model, recorded, free):
    parts = {path: evolve(model.parameters()[path], fixed=path not in free) for path in PARTS}
    force, stiffness = (part.value for part in parts.values())
    together = KnownSum(PARTS, 1.2 * force + stiffness, 0.1 * force)
    known = evolve(model.with_parameters(parts), sums=(together,))
    own, plain = (misfit(one, run=recorded(model)) for one in (known, evolve(known, sums=())))
    point = own.start()
    assert departure(own, point) == pytest.approx(4.0)
    gained = own.deviance(own.residual(point)) - plain.deviance(plain.residual(point))
    assert gained == pytest.approx(4.0)
    assert not own.is_strained(point)
    reached = own.with_values({PARTS[0]: 1.2 * force})
    assert departure(reached, reached.start()) == pytest.approx(0.0, abs=1e-9)
    far = own.with_values({PARTS[0]: 0.8 * force})
    assert far.is_strained(far.start())
    assert_jacobian(reached, 1e-6, 2e-5)


def test_a_sum_of_numbers_that_are_all_fixed_says_nothing(misfit, model, recorded):
    fixed = {path: evolve(model.parameters()[path], fixed=True) for path in PARTS}
    known = evolve(model.with_parameters(fixed), sums=(KnownSum(PARTS, 1e3, 0.1),))
    own = misfit(known, run=recorded(model))
    assert departure(own, own.start()) == 0.0


def test_misfits_that_differ_in_free_values_predict_alike_by_turns(misfit, recorded):
    """They share what is prepared of the runs, masses and the initial state among it, and leave each other's numbers alone."""
    model = toys.two_degrees()
    heavier = {"body.rear.mass": 1.1 * model.values()["body.rear.mass"]}
    given = misfit(model, run=recorded(model))
    other, alone = given.with_values(heavier), misfit(model.with_values(heavier), run=recorded(model))
    assert other.predictor is given.predictor
    first = given.residual(given.start())
    np.testing.assert_array_equal(other.residual(other.start()), alone.residual(alone.start()))
    np.testing.assert_array_equal(given.residual(given.start()), first)


def test_a_value_that_is_fixed_makes_another_predictor(misfit, recorded):
    path = "body.rear.mass"
    model = toys.two_degrees()
    fixed = model.with_parameters({path: evolve(model.parameters()[path], fixed=True)})
    given, value = misfit(fixed, run=recorded(model)), 1.1 * model.values()[path]
    other, alone = given.with_values({path: value}), misfit(fixed.with_values({path: value}), run=recorded(model))
    np.testing.assert_array_equal(other.residual(other.start()), alone.residual(alone.start()))
