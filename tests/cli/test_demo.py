"""The demonstration: what it conceals, what it diagnoses, and what it says when the seal is opened."""

import json
import webbrowser
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import pytest

from crashkit import api, demo
from crashkit.errors import CrashkitError
from crashkit.model.toml import read_model
from crashkit.registry import load
from crashkit.testing.concealed import SIZES, read_answer

SEED = 6
conceal = cache(demo.conceal)


def finding(physics: str, **location: object) -> SimpleNamespace:
    return SimpleNamespace(physics=physics, location=location)


def answer(*findings: SimpleNamespace) -> SimpleNamespace:
    return SimpleNamespace(summary="the answer", findings=findings)


def truth(physics: str, kind: str, place: object, *rivals: list) -> dict:
    secret = {"physics": physics, "form": "line", "kind": kind, "place": place}
    return {"accept": [[physics, kind, place], *rivals], "secrets": [secret]}


@pytest.fixture
def diagnosed(monkeypatch) -> list[tuple]:
    """The arguments of each diagnosis, which finds nothing."""
    calls = []

    def diagnose_files(*arguments):
        calls.append(arguments)
        return answer()

    monkeypatch.setattr(api, "diagnose_files", diagnose_files)
    monkeypatch.setattr(demo, "conceal", conceal)
    return calls


def test_what_is_diagnosed_is_a_model_three_runs_and_one_held_out(tmp_path, diagnosed):
    demo.run(SEED, tmp_path, False, print)
    model, runs, holdout, output, _ = diagnosed[0]
    assert read_model(model, load().spring_laws, load().observers).free_parameters()
    assert [path.name for path in runs] == ["run_1.nc", "run_2.nc", "run_3.nc"]
    assert [path.name for path in holdout] == ["holdout_1.nc"]
    assert output == tmp_path


def test_the_secret_lies_sealed_beside_the_recordings(tmp_path, diagnosed):
    demo.run(SEED, tmp_path, False, print)
    path = tmp_path / "case" / "answer.json"
    assert list(json.loads(path.read_text())) == ["sealed"]
    assert read_answer(path)["secrets"]


@pytest.mark.parametrize("seed", [SEED, SEED + 1])
def test_the_secret_is_one_that_an_installed_hypothesis_names_and_plain_to_see(seed):
    [secret] = conceal(seed).answer["secrets"]
    assert secret["physics"] in load().hypotheses
    assert secret["physics"] != "unknown"
    assert secret["left"] > SIZES["middle"][0]


def test_each_seed_has_a_secret_of_its_own_and_can_be_repeated():
    secrets = demo.conceal(SEED).answer["secrets"]
    assert secrets == conceal(SEED).answer["secrets"] != conceal(SEED + 1).answer["secrets"]


def test_without_a_seed_one_is_drawn_and_told(tmp_path, diagnosed, monkeypatch):
    drawn, told = [], []
    monkeypatch.setattr(demo, "conceal", lambda seed: drawn.append(seed) or conceal(SEED))
    text = demo.run(None, tmp_path, False, told.append)
    assert told[0].endswith(f"crashkit demo --seed {drawn[0]})")
    assert text.endswith(f"Seed {drawn[0]}.")


def test_the_answer_is_right_where_the_physics_and_the_place_are(diagnosed):
    told = demo.reveal(answer(finding("bottoming", joint="front")), truth("bottoming", "joint", "front"))
    assert told == "The seal is opened. Concealed was: bottoming at joint front.\nThe answer was right."


@pytest.mark.parametrize(
    "found",
    [[], [finding("bottoming", joint="rear")], [finding("clearance", joint="front")]],
    ids=["nothing was found", "another place", "another physics"],
)
def test_the_answer_is_wrong_where_one_of_them_is_not(found):
    assert demo.reveal(answer(*found), truth("bottoming", "joint", "front")).endswith("The answer was wrong.")


def test_something_that_is_not_there_is_told():
    found = answer(finding("bottoming", joint="front"), finding("bias", sensor="wall", instrument="wall"))
    told = demo.reveal(found, truth("bottoming", "joint", "front"))
    assert told.endswith("It was found, and besides something that is not there: bias.")


def test_two_bodies_may_be_named_in_any_order():
    found = answer(finding("missing_contact", bodies=["cabin", "wall"]))
    assert demo.reveal(found, truth("missing_contact", "bodies", ["wall", "cabin"])).endswith("The answer was right.")


def test_a_sensor_may_be_told_with_its_instrument_and_a_rival_is_as_right():
    found = answer(finding("gain_error", sensor="wall", instrument="wall"))
    assert demo.reveal(found, truth("added_mass", "body", "car", ["gain_error", "sensor", "wall"])).endswith("right.")


def test_a_file_in_the_place_of_the_folder(tmp_path, diagnosed):
    (tmp_path / "f").write_text("")
    with pytest.raises(CrashkitError, match="f: expected a folder to write to, found a file$"):
        demo.run(SEED, tmp_path / "f", False, print)


def test_a_seed_that_conceals_nothing(tmp_path, monkeypatch):
    def fail(*_, **__):
        raise ValueError("not plain to see")

    monkeypatch.setattr(demo, "make_case", fail)
    with pytest.raises(CrashkitError, match="^seed 6: expected one that conceals a physics, found none that fits its crash$"):
        demo.run(SEED, tmp_path / "new", False, print)
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("error", [OSError("no browser"), webbrowser.Error("no browser")])
def test_a_page_that_cannot_be_opened_is_no_error(tmp_path, diagnosed, monkeypatch, error):
    def fail(url):
        raise error

    monkeypatch.setattr(webbrowser, "open", fail)
    monkeypatch.setenv("DISPLAY", ":0")
    assert "the answer" in demo.run(SEED, tmp_path, True, print)


@pytest.mark.parametrize(("wanted", "shown"), [(True, 1), (False, 0)])
def test_the_page_is_opened_only_where_it_is_wanted(tmp_path, diagnosed, monkeypatch, wanted, shown):
    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    monkeypatch.setenv("DISPLAY", ":0")
    demo.run(SEED, tmp_path, wanted, print)
    assert opened == [(tmp_path / "index.html").resolve().as_uri()] * shown


@pytest.mark.slow
def test_a_secret_is_found(tmp_path: Path):
    told = demo.run(SEED, tmp_path, False, print)
    assert "The answer was right." in told
    assert (tmp_path / "index.html").is_file()
    assert (tmp_path / "augmented_model.toml").is_file()
