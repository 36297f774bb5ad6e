"""The trial: what counts as right, what is written, and that it goes on where it stopped."""

import json
from argparse import ArgumentParser

import pytest

from benchmarks import blind
from benchmarks.blind import trial as trials
from benchmarks.blind.plan import Ticket
from benchmarks.blind.score import score, verdicts
from benchmarks.blind.tables import by_physics, by_size, confusion, failures, reliability
from benchmarks.blind.trial import Trial, diagnosed, line, run_trial

RATE = ["rate_dependence", "joint", "front"]
BIAS = ["bias", "sensor", "cabin_a"]
CONTACT = ["missing_contact", "bodies", ["wall", "cabin"]]
UNKNOWN = ["unknown", "joint", "front"]
NOTHING = ["consistent", None, None]


def finding(physics, kind, place, probability=0.99, **more):
    return {"physics": physics, "location": {kind: place}, "probability": probability, **more}


def said(verdict, *findings):
    return {"verdict": verdict, "findings": list(findings)}


def truth(*accept, together=False):
    return {"accept": list(accept), "all": together}


@pytest.mark.parametrize(
    ("answer", "secret"),
    [
        (said("consistent"), truth(NOTHING)),
        (said("missing_physics", finding(*RATE)), truth(RATE)),
        (said("missing_physics", finding(*RATE)), truth(BIAS, RATE)),
        (said("sensor_fault", finding(*BIAS)), truth(BIAS)),
        (said("missing_physics", finding(*RATE), finding(*BIAS)), truth(BIAS, RATE, together=True)),
        (said("missing_physics", finding("missing_contact", "bodies", ["cabin", "wall"])), truth(CONTACT)),
        (said("unexplained", finding(*UNKNOWN)), truth(UNKNOWN)),
    ],
)
def test_right_answers(answer, secret):
    assert score(answer, secret).right


@pytest.mark.parametrize(
    ("answer", "secret", "wrong"),
    [
        (said("missing_physics", finding(*RATE)), truth(NOTHING), {"verdict", "physics", "place"}),
        (said("consistent"), truth(RATE), {"verdict", "physics", "place"}),
        (said("sensor_fault", finding(*RATE)), truth(RATE), {"verdict"}),
        (said("missing_physics", finding("rate_dependence", "joint", "rear")), truth(RATE), {"place"}),
        (said("missing_physics", finding("bottoming", "joint", "front")), truth(RATE), {"physics", "place"}),
        (said("missing_physics", finding(*RATE)), truth(BIAS, RATE, together=True), {"physics", "place"}),
        (said("unexplained", finding(*RATE), finding(*UNKNOWN)), truth(RATE), {"verdict"}),
        (said("missing_physics", finding(*BIAS)), truth(BIAS, RATE), {"verdict"}),
    ],
)
def test_wrong_answers(answer, secret, wrong):
    result = score(answer, secret)
    assert not result.right
    assert {name for name in ("verdict", "physics", "place") if not getattr(result, f"{name}_right")} == wrong


def test_what_is_claimed_beside_the_truth_is_spurious():
    result = score(said("missing_physics", finding(*RATE), finding(*BIAS)), truth(RATE))
    assert result.spurious == ("bias at sensor cabin_a",)
    assert not result.right
    assert result.claims == ((0.99, True), (0.99, False))


def test_a_sensor_is_the_place_even_where_its_instrument_is_named_too():
    located = {"physics": "bias", "location": {"sensor": "cabin_a", "instrument": "accelerometer"}, "probability": 1.0}
    assert score(said("sensor_fault", located), truth(BIAS)).right


def test_a_rival_counts_as_listed_not_as_right():
    rival = {"physics": "rate_dependence", "location": {"joint": "front"}, "probability": 0.3}
    result = score(said("missing_physics", finding("bottoming", "joint", "front", 0.7, alternatives=[rival])), truth(RATE))
    assert result.listed
    assert not result.place_right


def test_a_fault_of_an_instrument_beside_a_structural_secret_leaves_the_verdict_to_the_structure():
    assert verdicts([("rate_dependence", "joint", "front"), ("bias", "sensor", "a")], True) == {"missing_physics"}
    assert verdicts([("gain_error", "sensor", "a"), ("added_mass", "body", "b")], False) == {"sensor_fault", "missing_physics"}


@pytest.fixture
def tickets():
    return [Ticket(f"case_{n:04d}", (1, n), physics, "gross") for n, physics in enumerate([(), ("bias",), ("tension",)], 1)]


@pytest.fixture
def staged(monkeypatch):
    """Cases that are not really made, and a diagnosis that says "consistent" of all but the third, on which it crashes."""
    calls = []

    def make(ticket, folder):
        secret = [{"physics": p, "form": "f", "kind": "sensor", "place": "a", "left": 300.0} for p in ticket.physics]
        accept = [[p, "sensor", "a"] for p in ticket.physics] or [NOTHING]
        return {"accept": accept, "all": False, "size": "gross" if secret else None, "secrets": secret}

    def diagnose(case, output, limit):
        calls.append(case.name)
        if case.name == "case_0003":
            return {"status": "crashed", "seconds": 2.0}
        fit = {
            runs: {"before": {"normalised_rmse": 1.2}, "after": {"normalised_rmse": 1.1}}
            for runs in ("calibration", "holdout")
        }
        output.mkdir(parents=True)
        (output / "diagnosis.json").write_text(json.dumps(said("consistent") | {"fit": fit}))
        return {"status": "done", "seconds": 4.0}

    monkeypatch.setattr(trials, "make", make)
    monkeypatch.setattr(trials, "diagnosed", diagnose)
    return calls


def test_results_are_printed_and_written_as_they_come(tickets, staged, tmp_path, capsys):
    records = run_trial(tickets, Trial(10.0), tmp_path / "results.jsonl", 1)
    assert [record.get("right") for record in records] == [True, False, None]
    assert capsys.readouterr().out.splitlines() == [
        "case_0001  right  4 s  nothing, -: consistent",
        "case_0002  WRONG  4 s  bias, gross: consistent",
        "case_0003  crashed: tension, gross",
    ]
    assert [json.loads(one)["name"] for one in (tmp_path / "results.jsonl").read_text().splitlines()] == staged


def test_a_trial_goes_on_where_it_stopped(tickets, staged, tmp_path):
    run_trial(tickets[:2], Trial(10.0), tmp_path / "results.jsonl", 1)
    records = run_trial(tickets, Trial(10.0), tmp_path / "results.jsonl", 1)
    assert staged == ["case_0001", "case_0002", "case_0003"]
    assert [record["name"] for record in records] == staged


def test_another_seed_is_another_case(tickets, staged, tmp_path):
    run_trial(tickets[:1], Trial(10.0), tmp_path / "results.jsonl", 1)
    run_trial([Ticket("case_0001", (2, 1), (), "gross")], Trial(10.0), tmp_path / "results.jsonl", 1)
    assert staged == ["case_0001", "case_0001"]


def test_the_diagnosis_is_given_no_answer(tickets, staged, tmp_path):
    run_trial(tickets[:1], Trial(10.0, tmp_path), None, 1)
    assert (tmp_path / "answers" / "case_0001.json").exists()
    assert "accept" not in (tmp_path / "answers" / "case_0001.json").read_text()


def test_what_the_model_takes_up_is_counted_apart(tickets, staged):
    records = run_trial(tickets, Trial(10.0), None, 1)
    records[1]["truth"]["size"] = "hidden"
    assert "| hidden | 1 | 0 |" in by_size(records)
    assert "| gross | 1 | 0 |" in by_size(records)


def test_tables_count_what_is_right_and_what_failed(tickets, staged, tmp_path):
    records = run_trial(tickets, Trial(10.0), None, 1)
    assert "| nothing | 1 | 1 | 1 | 1 | 1 | 1 | 0 | 1.2 | 1.1 | 4 |" in by_size(records)
    assert "| gross | 2 | 0 | 0 | 0 | 0 | 1 | 1 | 1.2 | 1.1 | 3 |" in by_size(records)
    assert "| tension | 1 | 0 |" in by_physics(records)
    assert "| bias | consistent 1 |" in confusion(records)
    assert "| tension | crashed 1 |" in confusion(records)
    assert "| case_0002 | gross | bias (f, 300 sigma) at sensor a | consistent |" in failures(records)


def test_reliability_is_the_share_that_is_there():
    records = [{"claims": [[0.97, True], [0.96, False], [1.0, True]]}]
    assert "| 0.95 to 0.99 | 2 | 0.965 | 0.500 |" in reliability(records)
    assert "| 0.99 to 1 | 1 | 1.000 | 1.000 |" in reliability(records)


def test_a_study_writes_rows_results_and_tables(staged, tmp_path):
    parser = ArgumentParser()
    parser.add_argument("--json")
    blind.add_arguments(parser)
    options = parser.parse_args(["--cases", "2", "--seed", "1", "--only", "null", "--workers", "1"])
    options.json = tmp_path / "blind.json"
    rows = blind.run(options)
    assert [(row.case, row.ours, row.theirs) for row in rows] == [
        ("nothing: false alarms in 2", 0.0, 0.01),
        ("diagnosis, median", 4.0, 30.0),
    ]
    assert len((tmp_path / "blind.jsonl").read_text().splitlines()) == 2
    assert (tmp_path / "blind.md").read_text().startswith("### By size")


def test_a_diagnosis_that_takes_too_long_is_stopped(tmp_path):
    record = diagnosed(tmp_path, tmp_path / "output", 0.01)
    assert record["status"] == "timed out"


@pytest.mark.slow
def test_a_diagnosis_that_crashes_is_recorded_with_its_last_line(tmp_path):
    (tmp_path / "run_1.nc").write_text("no recording")
    (tmp_path / "holdout_1.nc").write_text("no recording")
    record = diagnosed(tmp_path, tmp_path / "output", 120.0)
    assert record["status"] == "crashed"
    assert record["error"]


def test_a_case_in_one_line(tickets):
    record = {"name": "case_0009", "physics": ["bias"], "size": "small", "status": "timed out"}
    assert line(record) == "case_0009  timed out: bias, small"
