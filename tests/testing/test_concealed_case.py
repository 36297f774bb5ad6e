"""Concealed cases: the same for the same seed, valid as files, true to their secret, silent about it."""

import json
import tomllib

import numpy as np
import pytest
import xarray as xr

from crashkit.api import load_model, load_recordings
from crashkit.model.checks import check_recording_against_model
from crashkit.testing.concealed import EFFECTS, SIZES, make_case, read_answer, write_answer, write_case
from crashkit.testing.concealed.effect import Stage
from crashkit.testing.concealed.given import OFF, tuned
from crashkit.testing.concealed.size import Tuning, left_when_fitted, named, samples
from crashkit.testing.concealed.vehicle import draw_scene


@pytest.fixture(scope="module")
def case():
    return make_case((1, 2), ("gain_error",), "middle")


def test_the_same_seed_makes_the_same_case_and_another_seed_another():
    one, again, other = (make_case(seed, (), "small") for seed in ((1, 2), (1, 2), (1, 3)))
    assert (again.model, again.answer) == (one.model, one.answer)
    assert all(a.identical(b) for a, b in zip(again.runs + again.holdout, one.runs + one.holdout, strict=True))
    assert other.model != one.model


def test_a_case_is_read_by_the_program_and_by_plain_xarray(case, tmp_path):
    write_case(case, tmp_path)
    recordings = load_recordings(sorted(tmp_path.glob("*.nc")))
    model = load_model(tmp_path / "model.toml")
    for name, recording in recordings.items():
        check_recording_against_model(recording, model, name)
    with xr.open_datatree(tmp_path / "run_1.nc") as tree:
        assert tree["accelerometer"]["acceleration"].dims == ("time", "sensor", "axis")


def test_the_held_out_run_is_the_fastest(case):
    speeds = [float(tree["initial"]["velocity"][0, 0]) for tree in case.runs + case.holdout]
    assert speeds == sorted(set(speeds))


def test_a_case_folder_holds_nothing_of_the_answer(case, tmp_path):
    write_case(case, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        "model.toml",
        "holdout_1.nc",
        *(f"run_{number}.nc" for number in range(1, len(case.runs) + 1)),
    }
    assert not any(b"gain" in path.read_bytes() for path in tmp_path.iterdir())


def test_the_secret_is_as_large_as_asked(case):
    (secret,) = case.answer["secrets"]
    least, most = SIZES["middle"]
    assert least <= secret["left"] <= most
    assert secret["left"] <= secret["change"] * 1.001
    assert case.answer["size"] == "middle"
    assert case.answer["accept"][0] == ["gain_error", "sensor", secret["place"]]


def test_nothing_concealed_is_consistent():
    answer = make_case((1, 3), (), "small").answer
    assert answer == {"accept": [["consistent", None, None]], "all": False, "size": None, "secrets": []}


def test_a_pair_has_to_be_found_whole():
    answer = make_case((1, 4), ("bias", "rate_dependence"), "gross").answer
    assert [accepted[0] for accepted in answer["accept"]] == ["bias", "rate_dependence"]
    assert answer["all"]


def test_a_joint_that_unloads_elastically_in_the_model_has_no_unloading_stiffness_there():
    case = make_case((1, 5), ("plastic_unloading",), "gross")
    joints = {joint["name"]: joint["parameters"] for joint in tomllib.loads(case.model)["joint"]}
    assert "unloading_stiffness" not in joints[case.answer["secrets"][0]["place"]]


def test_a_seal_hides_the_answer_until_it_is_opened(case, tmp_path):
    write_answer(case.answer, tmp_path / "answer.json")
    assert "gain_error" not in (tmp_path / "answer.json").read_text()
    assert read_answer(tmp_path / "answer.json") == json.loads(json.dumps(case.answer))


def test_an_open_answer_is_plain_json(case, tmp_path):
    write_answer(case.answer, tmp_path / "answer.json", sealed=False)
    assert json.loads((tmp_path / "answer.json").read_text()) == read_answer(tmp_path / "answer.json")


def test_what_cannot_be_had_is_said(monkeypatch):
    monkeypatch.setattr("crashkit.testing.concealed.draft._try", lambda *_: None)
    with pytest.raises(ValueError, match="that shows tension and bias by 250 to 5000 standard deviations"):
        make_case((1, 1), ("tension", "bias"), "gross")


def test_a_size_may_be_any_range():
    secret = make_case((1, 7), ("rate_dependence",), (90.0, 110.0), plain=True).answer["secrets"][0]
    assert 90.0 <= secret["left"] <= 110.0


def test_what_the_free_parameters_make_up_for_leaves_nothing():
    """However far they have to go, which two steps do not tell."""
    scene = draw_scene(np.random.default_rng(2), plain=True)
    recorded = samples(tuned(scene, np.array([0.5, -0.4, 0.3])))
    assert Tuning.of(scene).left(recorded) > 20.0
    assert left_when_fitted(scene, [], recorded) < 1.0


def test_what_another_secret_makes_up_for_leaves_nothing_either():
    scene = draw_scene(np.random.default_rng(2), plain=True)

    def late(one, factor):
        other = one.copy()
        other.instruments["film"].clock_offset = 1e-3 * factor
        return other

    recorded = samples(late(scene, 1.5))
    assert left_when_fitted(scene, [], recorded) > 20.0
    assert left_when_fitted(scene, [late], recorded) < 1.0


def test_what_leaves_less_than_anything_small_is_hidden():
    assert [named(sigmas) for sigmas in (7.9, 8.1, 41.0, 9000.0)] == ["hidden", "small", "middle", "gross"]


def test_a_plain_vehicle_has_one_body_one_law_and_every_instrument():
    for number in range(4):
        scene = draw_scene(np.random.default_rng(number), plain=True)
        assert {joint.law for joint in scene.world.joints.values()} == {"crush_plateau"}
        assert len(scene.bodies) == 1
        assert len(scene.speeds) == 4
        for name in ("film", "accelerometer"):
            assert {sensor.body for sensor in scene.instruments[name].sensors.values()} == set(scene.bodies)


def test_the_given_model_is_the_truth_but_for_fifteen_per_cent(monkeypatch):
    off = tomllib.loads(make_case((1, 3), (), "small").model)
    monkeypatch.setattr("crashkit.testing.concealed.given.OFF", 0.0)
    true = tomllib.loads(make_case((1, 3), (), "small").model)
    assert off["body"] == true["body"]
    for joint, exact in zip(off["joint"], true["joint"], strict=True):
        for name, value in joint["parameters"].items():
            assert value == pytest.approx(exact["parameters"][name], rel=OFF * 1.001)
    assert off["joint"] != true["joint"]


@pytest.mark.parametrize("wall", [True, False])
def test_friction_against_the_obstacle_is_told_from_the_ground_only_by_a_load_cell(wall):
    rng = np.random.default_rng(3)
    scene = draw_scene(rng, wall=wall)
    while len(scene.bodies) > 1 or ("load_cell" in scene.instruments) is not wall:
        scene = draw_scene(rng, wall=wall)
    stage = Stage(scene, scene.motions(), rng)
    for one, other in (("joint_friction", "ground_friction"), ("ground_friction", "joint_friction")):
        effect = EFFECTS[one](stage)
        assert effect is not None
        assert [answer[0] for answer in effect.answers()] == ([one] if wall else [one, other])


def test_a_plain_secret_has_the_plainest_form():
    case = make_case((1, 6), ("rate_dependence",), "gross", plain=True)
    assert case.answer["secrets"][0]["form"] == "linear"
