"""Whole cases: the same for the same seed, valid as files, true to their secret."""

import json
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crashkit.testing.concealed import PHYSICS, SIZES, Case, make_case, open_seal, write_case
from crashkit.testing.concealed.case import EFFECTS, draw_draft
from crashkit.testing.concealed.effect import Stage
from crashkit.testing.concealed.significance import signals, traces
from crashkit.testing.concealed.vehicle import draw_scene


@pytest.fixture(scope="module")
def case() -> Case:
    return make_case(3, "gain_error")


def test_the_same_seed_makes_the_same_case(case: Case) -> None:
    again = make_case(3, "gain_error")
    assert again.model_toml == case.model_toml
    assert again.truth == case.truth
    assert all(one.identical(other) for one, other in zip(again.runs + again.holdout, case.runs + case.holdout, strict=True))


def test_another_seed_makes_another_case() -> None:
    assert make_case(4, "null").model_toml != make_case(5, "null").model_toml


def test_a_written_case_opens_without_crashkit(case: Case, tmp_path: Path) -> None:
    write_case(case, tmp_path, sealed=False)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "holdout_1.nc",
        "model.toml",
        "run_1.nc",
        "run_2.nc",
        "run_3.nc",
        "truth.json",
    ]
    with xr.open_datatree(tmp_path / "run_1.nc") as tree:
        assert tree.attrs["crashkit_schema"] == "recording/1"
        assert tree["film"]["position"].attrs["units"] == "m"
        assert tree["film"]["position"].dims == ("time", "marker", "axis")
        xr.testing.assert_equal(tree["accelerometer"].to_dataset(), case.runs[0]["accelerometer"].to_dataset())
    assert json.loads((tmp_path / "truth.json").read_text())["accept"] == [list(answer) for answer in case.truth["accept"]]


def test_a_written_case_is_plain_netcdf(case: Case, tmp_path: Path) -> None:
    write_case(case, tmp_path)
    try:
        header = subprocess.run(["ncdump", "-h", tmp_path / "run_1.nc"], capture_output=True, text=True, check=True).stdout
    except FileNotFoundError:
        pytest.skip("ncdump is not installed")
    assert 'observer = "accelerometer"' in header


def test_a_seal_hides_the_answer_until_it_is_opened(case: Case, tmp_path: Path) -> None:
    write_case(case, tmp_path)
    assert "gain_error" not in (tmp_path / "truth.json").read_text()
    assert open_seal(tmp_path) == json.loads(json.dumps(case.truth))


def test_the_public_model_is_the_truth_but_for_fifteen_per_cent_and_the_secret() -> None:
    case = make_case(5, "plastic_unloading")
    model, secret = tomllib.loads(case.model_toml), case.truth["secret"]
    assert model["schema"] == "crashkit-model/1"
    for joint in model["joint"]:
        for name, value in joint["parameters"].items():
            assert value / secret["parameters"][joint["name"]][name] == pytest.approx(1.0, abs=0.1501)
    guilty = next(joint for joint in model["joint"] if joint["name"] == secret["effects"][0]["place"])
    assert "unloading_stiffness" not in guilty["parameters"]


def test_runs_get_faster_and_the_holdout_is_the_fastest(case: Case) -> None:
    speeds = [float(tree["initial"]["velocity"][0, 0]) for tree in case.runs + case.holdout]
    assert speeds == sorted(set(speeds))


def test_nothing_concealed_leaves_the_public_world() -> None:
    draft = draw_draft(np.random.default_rng(1), [], None)
    assert np.array_equal(signals(draft.scene), signals(draft.base))
    truth = make_case(1, "null").truth
    assert truth["accept"] == [["consistent", None, None]]
    assert truth["secret"]["effects"] == []


@pytest.mark.parametrize("physics", EFFECTS)
def test_every_effect_changes_the_recordings_and_vanishes_with_its_strength(physics: str) -> None:
    rng = np.random.default_rng(2)
    scene = draw_scene(rng, number=3, wall=True, complete=True)
    effect = None
    while effect is None:
        effect = EFFECTS[physics](Stage(scene, traces(scene), rng))
    # Not at strength 0 itself: an obstacle without mobility, or a load without mass, is no body.
    changes = [np.linalg.norm(signals(effect.into(scene, strength)) - signals(scene)) for strength in (1.0, 1e-4)]
    assert changes[0] > 20.0
    assert changes[1] < 0.2 * changes[0]


@pytest.mark.parametrize("size", ["small", "gross"])
def test_a_secret_is_as_visible_as_asked(size: str) -> None:
    truth = make_case(7, "bias", size).truth
    least, most = SIZES[size]
    assert truth["size"] == size
    assert least <= truth["secret"]["effects"][0]["sigmas_after_tuning"] <= most


def test_the_truth_names_the_secret(case: Case) -> None:
    (effect,) = case.truth["secret"]["effects"]
    assert [effect["physics"], effect["kind"], effect["place"]] == case.truth["accept"][0]
    assert not case.truth["all"]
    assert effect["place"] in case.runs[0]["accelerometer"]["sensor"] or effect["place"] == "wall"


def test_a_pair_has_to_be_found_whole() -> None:
    truth = make_case(3, ("bias", "rate_dependence")).truth
    assert [answer[0] for answer in truth["accept"]] == ["bias", "rate_dependence"]
    assert truth["all"]


def test_chance_decides_what_is_not_asked_for() -> None:
    truth = make_case(12).truth
    assert all(answer[0] in (*PHYSICS, "consistent") for answer in truth["accept"])


def test_physics_that_is_not_known_is_refused() -> None:
    with pytest.raises(ValueError, match=r"expected physics among rate_dependence, .*, found gravity"):
        make_case(1, "gravity")


def test_a_size_that_is_not_known_is_refused() -> None:
    with pytest.raises(ValueError, match="expected a size among small, middle, gross, found huge"):
        make_case(1, "bias", "huge")


@pytest.mark.parametrize(("wall", "answers"), [(True, 1), (False, 2)])
def test_friction_against_the_obstacle_is_told_from_the_ground_only_by_a_wall_force(wall: bool, answers: int) -> None:
    rng = np.random.default_rng(3)
    scene = draw_scene(rng, number=1, wall=wall)
    effect = EFFECTS["joint_friction"](Stage(scene, traces(scene), rng))
    assert effect is not None
    assert len(effect.answers()) == answers
