"""A diagnosis from end to end, on a mass and a wall: what is concealed is found, and nothing else."""

import json

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.data.channel_filter import filter_channel
from crashkit.diagnose import diagnose
from crashkit.diagnose.result import place_of, run_name
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.report.document import diagnosis_json

RIVALS = ("bias", "clearance", "clock_offset", "gain_error", "unknown", "viscous_damping")
OFFSET = 6.0
"""m s-2."""


@pytest.fixture(scope="module")
def diagnosed(workshop, model, recorded):
    """The diagnosis of a model 8 % off, from runs at two speeds and a faster one that is held out."""
    believed = model.with_values({path: 1.08 * p.value for path, p in model.free_parameters().items()})

    def run(true=model, speeds=SPEEDS, rivals=RIVALS, held_out=lambda run: run, **changes):
        few = evolve(workshop, hypotheses={name: workshop.hypotheses[name] for name in rivals})
        runs = {name: recorded(true, speed, seed, **changes) for seed, (name, speed) in enumerate(speeds.items(), 1)}
        fitted = {name: runs[name] for name in ("slow.nc", "fast.nc")}
        return diagnose(believed, fitted, {"faster.nc": held_out(runs["faster.nc"])}, few)

    return run


SPEEDS = {"slow.nc": 0.9, "fast.nc": 1.2, "faster.nc": 1.35}


@pytest.fixture(scope="module")
def with_dashpot(model):
    numbers = {"damping": _fixed(800.0), "clearance": _fixed(0.0), "engagement": _fixed(1e-3)}
    return with_joint(model, Joint("dashpot", ("wall", "front"), "viscous", numbers))


@pytest.fixture(scope="module")
def nothing(diagnosed):
    return diagnosed()


@pytest.fixture(scope="module")
def bias(diagnosed):
    return diagnosed(accelerometer=lambda dataset: dataset.assign(acceleration=dataset["acceleration"] + OFFSET))


@pytest.fixture(scope="module")
def late_and_damped(diagnosed, with_dashpot):
    """Its recorder starts 1.5 ms early, and the structure has a dashpot that the model has not."""
    return diagnosed(with_dashpot, accelerometer=_late)


def _late(dataset):
    values = dataset["acceleration"].values
    return dataset.assign(acceleration=(dataset["acceleration"].dims, np.concatenate([0.0 * values[:6], values[:-6]])))


@pytest.fixture(scope="module")
def damped(diagnosed, with_dashpot):
    """The structure itself is other than believed: a dashpot acts beside the spring."""
    return diagnosed(with_dashpot)


@pytest.fixture(scope="module")
def snapping(diagnosed, model):
    """Something catches between 0.2 and 0.3 m, and lets go: no installed physics does."""
    heights = tuple(1.5e4 if 10 <= number < 14 else 0.0 for number in range(24))
    bump = {"heights": heights, "reach": 0.48, "unloading_length": 0.02, "engagement": 1e-3}
    parameters = {name: _fixed(value) for name, value in bump.items()}
    return diagnosed(with_joint(model, Joint("snap", ("wall", "front"), "smooth_table", parameters)))


@pytest.fixture(scope="module")
def stopped_late(stopping_late, model):
    return stopping_late(model)


@pytest.fixture(scope="module")
def stopping_late(diagnosed, simulated):
    """Something hard is hit, but only in the run that is held out."""

    def run(true, **changes):
        reached = [float(simulated(true, speed)["deformation"].max()) for speed in SPEEDS.values()]
        stop = {"stiffness": _fixed(6e5), "stop_deformation": _fixed(0.5 * (reached[1] + reached[2]))}
        spring, *others = true.joints
        hard = evolve(spring, law="crush_plateau + linear_stop", parameters={**spring.parameters, **stop})
        rivals = ("bias", "bottoming", "viscous_damping")
        return diagnosed(evolve(true, joints=(hard, *others)), rivals=rivals, **changes)

    return run


def _filtered(dataset):
    """To CFC 180, with a noise that nobody states."""
    read, times = dataset["acceleration"], dataset["time"].values
    filtered = read.copy(data=filter_channel(read.values, times, 180.0, read.dims.index("time"), before=0.0))
    untold = dataset.assign(acceleration=filtered).drop_vars("acceleration_std")
    return untold.assign_attrs(channel_frequency_class=180)


def _fixed(value):
    return tuple(map(_fixed, value)) if isinstance(value, tuple) else Parameter(value, fixed=True)


def test_where_nothing_is_concealed_nothing_is_found(nothing):
    assert nothing.verdict == "consistent"
    assert nothing.findings == ()
    assert nothing.summary.startswith("Simulation and recordings agree")


def test_noise_of_which_too_little_is_stated_is_no_physics(diagnosed):
    told = diagnosed(accelerometer=lambda dataset: dataset.assign(acceleration_std=0.6 * dataset["acceleration_std"]))
    assert told.verdict == "consistent" and told.findings == ()
    for fits in told.fits.values():
        assert fits["after"].normalised_rmse == pytest.approx(1.0, abs=0.08)
    assert any(note.startswith("the noise of accelerometer/front_sensor is 1.") for note in told.notes)


def test_the_models_own_parameters_are_re_identified(nothing, model):
    for path, true in model.free_parameters().items():
        assert nothing.base_model.parameters()[path].value == pytest.approx(true.value, rel=0.01), path
    assert nothing.fits["calibration"]["before"].normalised_rmse == pytest.approx(1.0, abs=0.05)
    assert nothing.augmented_model == nothing.base_model


def test_an_offset_is_found_where_it_is(bias):
    assert bias.verdict == "sensor_fault"
    (finding,) = bias.findings
    assert (finding.physics, dict(finding.location)) == ("bias", {"sensor": "front_sensor", "instrument": "accelerometer"})
    assert finding.probability > 0.95
    assert set(finding.runs) == {"slow.nc", "fast.nc"}
    estimate = finding.parameters["bias"]
    assert estimate.units == "m s-2"
    assert abs(estimate.value - OFFSET) < 5.0 * estimate.std < 1.0


def test_an_offset_explains_the_misfit_of_runs_that_were_not_fitted(bias):
    for runs in ("calibration", "holdout"):
        before, after = (bias.fits[runs][when].normalised_rmse for when in ("before", "after"))
        assert before > 1.5, runs
        assert after == pytest.approx(1.0, abs=0.1), runs
    assert bias.fits["holdout"]["after"].channels["channel"].values.tolist() == [
        "faster.nc/film/front_marker",
        "faster.nc/accelerometer/front_sensor",
    ]


def test_a_late_clock_is_found_before_the_structure_is_accused(late_and_damped):
    findings = {finding.physics: finding for finding in late_and_damped.findings}
    assert set(findings) == {"clock_offset", "viscous_damping"}
    assert dict(findings["clock_offset"].location) == {"instrument": "accelerometer"}
    assert findings["clock_offset"].parameters["clock_offset"].value == pytest.approx(1.5e-3, abs=5e-5)
    assert findings["viscous_damping"].parameters["damping"].value == pytest.approx(800.0, rel=0.05)


def test_instruments_contradict_each_other_without_any_model(bias):
    worst = bias.consistency.isel(check=int(np.argmax(bias.consistency["sigma"].values)))
    assert str(worst["error"].values) == "bias"
    assert "inconsistent" in str(worst["sentence"].values)


def test_what_only_the_held_out_run_shows_is_found_and_nothing_is_called_predicted(stopped_late):
    (finding,) = stopped_late.findings
    assert (finding.physics, dict(finding.location)) == ("bottoming", {"joint": "first"})
    assert "faster.nc" in finding.runs
    assert abs(finding.parameters["stiffness"].value - 6e5) < 4.0 * finding.parameters["stiffness"].std
    assert stopped_late.fits["calibration"]["after"].normalised_rmse == pytest.approx(1.0, abs=0.05)
    assert stopped_late.fits["holdout"] == {} and stopped_late.curves["faster.nc/film"].attrs["holdout"] == 0
    assert stopped_late.summary.endswith(stopped_late.notes[0])
    assert stopped_late.notes[0].startswith("faster.nc: ") and "nothing here was predicted" in stopped_late.notes[0]


def test_a_held_out_run_that_cannot_be_simulated_is_not_predicted_and_all_else_is_told(diagnosed):
    def hurled(run):
        state = run["initial"].to_dataset(inherit=False)
        return run.assign({"initial": xr.DataTree(state.assign(velocity=1e305 * state["velocity"]))})

    told = diagnosed(held_out=hurled)
    assert told.verdict == "consistent"
    assert told.fits["holdout"] == {}
    assert told.notes[0].startswith("faster.nc: not predicted, as that cannot be simulated: model one degree of freedom: ")
    assert told.summary.endswith(told.notes[0])


def test_so_it_is_where_the_noise_of_an_instrument_is_open(stopping_late, model):
    (finding,) = stopping_late(model, accelerometer=_filtered).findings
    assert (finding.physics, dict(finding.location)) == ("bottoming", {"joint": "first"})


@pytest.mark.long
def test_nor_does_an_open_noise_hide_it_beside_something_that_all_runs_show(stopping_late, with_dashpot):
    findings = stopping_late(with_dashpot, accelerometer=_filtered).findings
    assert {finding.physics for finding in findings} == {"viscous_damping", "bottoming"}


def test_curves_hold_what_was_recorded_and_both_models(bias):
    curve = bias.curves["faster.nc/accelerometer"]
    assert curve.attrs["holdout"] == 1 and bias.curves["slow.nc/film"].attrs["holdout"] == 0
    left = (curve["recorded"] - curve["after"]) / curve["std"]
    assert float(np.sqrt((left**2).mean())) == pytest.approx(1.0, abs=0.1)


def test_the_ranking_begins_with_the_finding(bias):
    first = bias.ranking.isel(hypothesis=0)
    assert (str(first["physics"].values), int(first["round"])) == ("bias", 1)
    assert float(first["misfit_drop"]) == float(bias.ranking["misfit_drop"].sel(hypothesis=bias.ranking["round"] == 1).max())


def test_what_was_found_predicts_the_runs_that_are_left_out(bias):
    first = bias.ranking.isel(hypothesis=0)
    assert float(first["left_out_drop"]) == pytest.approx(float(first["misfit_drop"]), rel=0.3)


def test_the_summary_tells_the_finding_in_words(bias):
    assert "an instrument is wrong, not the structure" in bias.summary
    assert "sensor front_sensor has an offset; bias" in bias.summary
    assert "held-out runs: " in bias.summary


def test_the_document_for_programs_is_complete(bias):
    document = json.loads(json.dumps(diagnosis_json(bias), allow_nan=False))
    assert document["schema"] == "crashkit-diagnosis/1"
    assert document["verdict"] == "sensor_fault"
    assert document["findings"][0]["physics"] == "bias"
    assert document["findings"][0]["parameters"]["bias"]["units"] == "m s-2"
    assert document["fit"]["holdout"]["after"]["normalised_rmse"] < document["fit"]["holdout"]["before"]["normalised_rmse"]


def test_physics_that_the_structure_hides_is_named_and_measured(damped):
    assert damped.verdict == "missing_physics"
    (finding,) = damped.findings
    assert (finding.physics, dict(finding.location)) == ("viscous_damping", {"joint": "first"})
    estimate = finding.parameters["damping"]
    assert estimate.units == "N s m-1"
    assert abs(estimate.value - 800.0) < 5.0 * estimate.std < 100.0
    assert finding.sentence.startswith("joint first is damped")


def test_the_augmented_model_predicts_the_run_that_was_held_out(damped):
    fits = damped.fits["holdout"]
    assert fits["before"].normalised_rmse > 1.3
    assert fits["after"].normalised_rmse == pytest.approx(1.0, abs=0.1)
    assert len(damped.augmented_model.joints) == len(damped.base_model.joints) + 1


def test_the_missing_force_is_shown_beside_what_the_finding_adds(damped):
    assert list(damped.missing_force["0"].children) == ["slow.nc", "fast.nc", "faster.nc"]
    for run, node in damped.missing_force["0"].children.items():
        assert (node.attrs["place"], node.attrs["holdout"]) == ("joint first", int(run == "faster.nc"))
        modelled = node["modelled_force"].values
        assert modelled.max() > 5e3
        loading = node["deformation_rate"].values > 3.0  # what a stiff unloading asks for magnifies every millimetre
        gap = (node["missing_force"].values - modelled)[loading]
        assert np.sqrt(np.mean(gap**2)) < 0.25 * modelled.max()


PLACES = [
    ({"joint": "front"}, "joint front"),
    ({"bodies": ["engine", "wall"]}, "bodies engine and wall"),
    ({"sensor": "roof", "instrument": "film"}, "sensor roof"),
    ({"instrument": "film"}, "instrument film"),
    ({"body": "car"}, "body car"),
]


def test_a_force_that_nobody_knows_is_estimated_and_predicts(snapping):
    assert snapping.verdict == "unexplained"
    (finding,) = snapping.findings
    assert (finding.physics, dict(finding.location)) == ("unknown", {"joint": "first"})
    # No run comes back to where the force acts, so that none tells whether it is given back there, or acts from afar.
    assert finding.form.startswith("deformation")
    assert "strongest with" in finding.sentence
    held_out = snapping.fits["holdout"]
    assert held_out["before"].normalised_rmse > 2.0
    assert held_out["after"].normalised_rmse < 1.3


def test_a_number_that_nothing_shows_stays_where_it_was_given(diagnosed, model):
    gentle = {"slow.nc": 0.2, "fast.nc": 0.25, "faster.nc": 0.3}
    identified = diagnosed(speeds=gentle).identified.sel(parameter="joint.first.densification_stiffness")
    given = 1.08 * model.parameters()["joint.first.densification_stiffness"].value
    assert float(identified["value"]) == pytest.approx(given, rel=1e-6)
    assert not bool(identified["identifiable"])


@pytest.mark.parametrize(("location", "words"), PLACES)
def test_places_in_words(location, words):
    assert place_of(location) == words


def test_a_run_is_called_like_its_file():
    assert run_name("tests/of/june/run_1.nc") == "run_1.nc"
