"""Numbers in the summary of a diagnosis."""

import math
from types import SimpleNamespace

import pytest
import xarray as xr
from attrs import evolve, fields

from crashkit.data.filter_ends import UNSETTLED
from crashkit.diagnose.result import Alternative, Diagnosis, Estimate, Finding, Fit
from crashkit.diagnose.show.fits import is_misleading
from crashkit.diagnose.show.words import (
    VERDICTS,
    cut_short,
    far_off,
    noted,
    nothing_predicted,
    number,
    of_prediction,
    summarise,
)
from crashkit.protocols import Status


@pytest.mark.parametrize(
    ("estimate", "expected"),
    [
        (Estimate(160200.0, 912.0, "N"), "1.602e+05 ± 9.1e+02 N"),
        (Estimate(0.25, 0.01, "1"), "0.25 ± 0.01"),
        (Estimate(0.02, math.nan, "m"), "0.02 m (no interval)"),
        (Estimate(0.02, math.inf, "m"), "0.02 m (no interval)"),
        (Estimate(0.02, math.nan, "m", identifiable=False), "0.02 m (no interval)"),
        (Estimate(0.02, 350.0, "m", identifiable=False), "0.02 m (not identifiable)"),
    ],
)
def test_a_number_is_told_with_its_deviation_if_it_has_one(estimate: Estimate, expected: str) -> None:
    assert number(estimate) == expected


@pytest.mark.parametrize(
    ("before", "after", "expected", "told"),
    [
        (3.0, 1.04, 30.0, []),
        (
            3.0,
            1.4,
            1.6,
            ["foretell the held-out ones only to about 1.6 times the noise; what they do not tell is mostly beta"],
        ),
        (3.0, 1.4, 1.01, ["Of the right model about 1.01 times the noise is to be expected"]),
        (3.0, 9.0, 1.6, ["predicted worse than before", "Of the right model about 1.60 times"]),
    ],
)
def test_a_prediction_is_told_with_what_can_be_expected_of_it(before, after, expected, told):
    fits = {"before": Fit(before, xr.Dataset()), "after": Fit(after, xr.Dataset(), expected, "beta")}
    sentences = of_prediction(fits)
    assert len(sentences) == len(told)
    assert all(part in sentence for part, sentence in zip(told, sentences, strict=True))


@pytest.mark.parametrize(
    ("expected", "together", "told"),
    [
        (
            13.0,
            1.01,
            "explains all runs (1.01 times the noise): nothing else is missing, but the fitted runs alone do not tell all "
            "of its numbers, mostly beta.",
        ),
        (1.01, 1.01, "the fitted runs alone do not tell all of its numbers."),
        (1.01, 2.3, "a law has another form than the model says, or something is missing"),
        (13.0, 2.3, "a law has another form than the model says, or something is missing"),
    ],
)
def test_runs_that_other_values_explain_do_not_speak_against_the_model(expected, together, told):
    """What they were fitted together with leaves next to nothing of all."""
    fits = {"before": Fit(20.0, xr.Dataset()), "after": Fit(18.8, xr.Dataset(), expected, "beta", together)}
    (sentence,) = of_prediction(fits)
    assert told in sentence


@pytest.mark.parametrize(("together", "misleads"), [(1.01, False), (2.3, True), (math.nan, True)])
def test_what_other_values_would_predict_is_believed(together, misleads):
    fits = {"before": Fit(3.0, xr.Dataset()), "after": Fit(9.0, xr.Dataset(), 1.6, "beta", together)}
    assert is_misleading(fits) is misleads


@pytest.mark.parametrize(
    ("before", "after", "expected", "misleads"),
    [(3.0, 9.0, 1.6, True), (3.0, 9.0, 30.0, False), (3.0, 2.9, 1.6, False), (3.0, 9.0, math.nan, False)],
)
def test_what_held_out_runs_speak_against_is_not_believed(before, after, expected, misleads):
    """They are predicted worse than before, though the fitted runs would foretell them."""
    assert is_misleading({"before": Fit(before, xr.Dataset()), "after": Fit(after, xr.Dataset(), expected)}) is misleads
    assert not is_misleading({})


def test_where_a_rival_says_the_same_of_another_place_both_are_told_together():
    def diagnosed(finding):
        return summarise("missing_physics", [finding], {"calibration": {}, "holdout": {}}, xr.Dataset(), xr.Dataset())

    friction = Finding("joint_friction", "sharp", "it rubs", 0.48, {"joint": "a"}, (), (0.0, 1.0), "both", {})
    rival = Alternative("joint_friction", "sharp", {"joint": "b"}, 0.48)
    assert "joint_friction, at one of these places: 0.960" in diagnosed(evolve(friction, alternatives=(rival,)))
    hardly = evolve(rival, probability=1e-4)
    assert "at one of these places" not in diagnosed(evolve(friction, alternatives=(hardly,)))
    other = evolve(rival, physics="viscous_damping")
    assert "at one of these places" not in diagnosed(evolve(friction, alternatives=(other,)))


def test_what_was_not_found_in_time_is_not_called_unknown():
    nothing = dict.fromkeys(field.name for field in fields(Diagnosis))
    told = cut_short(Diagnosis(**{**nothing, "summary": VERDICTS["unexplained"], "notes": ()}), 5.0)
    assert told.summary.startswith("Simulation and recordings differ; what explains it was not found in the time")
    assert told.notes[0].startswith("the time for questions was up after 5 s")
    assert told.time_up == 5.0


@pytest.mark.parametrize(
    ("at_other_values", "how"), [(True, "explains this only at other values of its"), (False, "cannot explain this beside")]
)
def test_a_run_that_had_to_be_fitted_is_no_test_any_more(at_other_values, how):
    empty = dict.fromkeys(field.name for field in fields(Diagnosis))
    told = nothing_predicted(Diagnosis(**{**empty, "summary": "", "notes": ()}), ["faster.nc"], at_other_values)
    assert told.notes[0].startswith(f"faster.nc: what explains the other runs {how}") and told.notes[0] in told.summary
    assert told.notes[0].endswith("nothing here was predicted, hold another run out")


def test_without_held_out_runs_nothing_is_said_of_prediction():
    assert of_prediction({}) == []


def test_a_number_that_came_out_far_from_what_was_given_is_noted(model):
    path, stiffness = next(iter(model.free_parameters().items()))
    assert far_off(model, model) == []
    assert far_off(model, model.with_values({path: 2.0 * stiffness.value})) == []
    (note,) = far_off(model, model.with_values({path: 0.3 * stiffness.value}))
    assert note.startswith(f"{path} came out at {0.3 * stiffness.value:.4g}, far from the {stiffness.value:.4g}")


@pytest.mark.parametrize(
    ("findings", "pointer", "notes"), [(("one",), "there", ["there"]), ((), "there", []), (("one",), None, [])]
)
def test_what_pointed_to_a_place_is_noted_with_the_finding_there(findings, pointer, notes):
    discovery = SimpleNamespace(findings=findings, pointer=pointer, final=SimpleNamespace(channels=(), groups=()))
    result = SimpleNamespace(status=Status.CONVERGED, unseen=())
    fits = {"calibration": {"after": Fit(1.0, xr.Dataset())}, "holdout": {}}
    assert list(noted(discovery, result, fits)) == notes


@pytest.mark.parametrize(("seconds", "notes"), [(0.00361, 1), (0.0, 0)])
def test_ends_that_a_filter_has_made_up_are_noted(seconds, notes):
    wall = SimpleNamespace(
        name="wall", dataset=xr.Dataset(attrs={UNSETTLED: seconds}), observer=SimpleNamespace(quantity="force")
    )
    discovery = SimpleNamespace(findings=(), pointer=None, final=SimpleNamespace(channels=(), groups=(wall, wall)))
    result = SimpleNamespace(status=Status.CONVERGED, unseen=())
    told = noted(discovery, result, {"calibration": {"after": Fit(1.0, xr.Dataset())}, "holdout": {}})
    expected = "the first and last 3.6 ms of wall count as missing: its filter was not told of the rest before the impact"
    assert list(told) == [expected] * notes
