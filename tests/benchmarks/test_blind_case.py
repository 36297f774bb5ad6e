"""Cases of the blind trial: the same for the same seed, valid as files, true to their secret, silent about it."""

import json
import tomllib

import numpy as np
import pytest
import xarray as xr

from benchmarks.blind import make as making
from benchmarks.blind.case import EFFECTS, make_case, write_case
from benchmarks.blind.make import main, make, read_answer, write_answer
from benchmarks.blind.plan import Ticket, plan
from benchmarks.blind.size import SIZES
from crashkit.api import load_model, load_recordings
from crashkit.model.checks import check_recording_against_model


@pytest.fixture(scope="module")
def case():
    return make_case((1, 2), ("gain_error",), "middle")


def test_the_same_seed_makes_the_same_case_and_another_seed_another():
    one, again, other = (make_case(seed, (), "small") for seed in ((1, 2), (1, 2), (1, 3)))
    assert (again.model, again.truth) == (one.model, one.truth)
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
    (secret,) = case.truth["secrets"]
    least, most = SIZES["middle"]
    assert least <= secret["left"] <= most
    assert secret["left"] <= secret["change"] * 1.001
    assert case.truth["size"] == "middle"
    assert case.truth["accept"][0] == ["gain_error", "sensor", secret["place"]]


def test_nothing_concealed_is_consistent():
    truth = make_case((1, 3), (), "small").truth
    assert truth == {"accept": [["consistent", None, None]], "all": False, "size": None, "secrets": []}


def test_a_pair_has_to_be_found_whole():
    truth = make_case((1, 4), ("bias", "rate_dependence"), "gross").truth
    assert [answer[0] for answer in truth["accept"]] == ["bias", "rate_dependence"]
    assert truth["all"]


def test_a_joint_that_unloads_elastically_in_the_model_has_no_unloading_stiffness_there():
    case = make_case((1, 5), ("plastic_unloading",), "gross")
    joints = {joint["name"]: joint["parameters"] for joint in tomllib.loads(case.model)["joint"]}
    assert "unloading_stiffness" not in joints[case.truth["secrets"][0]["place"]]


def test_what_cannot_be_had_is_said(monkeypatch, tmp_path):
    monkeypatch.setattr("benchmarks.blind.case._try", lambda *_: None)
    with pytest.raises(ValueError, match="no vehicle was found that shows tension and bias in gross size"):
        make_case((1, 1), ("tension", "bias"), "gross")
    assert make(Ticket("case_0001", (1, 1), ("tension",), "gross"), tmp_path) is None


def test_a_seal_hides_the_answer_until_it_is_opened(case, tmp_path):
    write_answer(case.truth, tmp_path / "answer.json")
    assert "gain_error" not in (tmp_path / "answer.json").read_text()
    assert read_answer(tmp_path / "answer.json") == json.loads(json.dumps(case.truth))


def test_an_open_answer_is_plain_json(case, tmp_path):
    write_answer(case.truth, tmp_path / "answer.json", sealed=False)
    assert json.loads((tmp_path / "answer.json").read_text()) == read_answer(tmp_path / "answer.json")


def test_a_longer_trial_begins_with_the_shorter_one():
    assert plan(40, 7)[:10] == plan(10, 7)
    assert plan(10, 7) != plan(10, 8)


def test_a_trial_holds_everything():
    tickets = plan(400, 1)
    concealed = {name for ticket in tickets for name in ticket.physics}
    assert concealed == set(EFFECTS)
    assert 0.08 < np.mean([not ticket.physics for ticket in tickets]) < 0.22
    assert 0.08 < np.mean([len(ticket.physics) == 2 for ticket in tickets]) < 0.22
    assert {ticket.size for ticket in tickets} == set(SIZES)


def test_only_what_is_asked_for_is_concealed_in_turn():
    tickets = plan(6, 1, ("null", "bias", "tension"), ("gross",))
    assert sorted(ticket.physics for ticket in tickets) == [(), (), ("bias",), ("bias",), ("tension",), ("tension",)]
    assert {ticket.size for ticket in tickets} == {"gross"}


def test_the_command_puts_cases_and_answers_apart(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(making, "make", lambda ticket, folder: {"accept": [[ticket.size, None, None]]})
    main(["--cases", "2", "--only", "null", "--open", str(tmp_path)])
    assert capsys.readouterr().out.split() == ["case_0001", "case_0002"]
    assert (tmp_path / "answers" / "case_0002.json").exists()
