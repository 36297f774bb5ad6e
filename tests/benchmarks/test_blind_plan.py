"""Which cases a trial makes, and the command that only makes them."""

import numpy as np

from benchmarks.blind import make as making
from benchmarks.blind.make import main, make
from benchmarks.blind.plan import Ticket, plan
from crashkit.testing.concealed import EFFECTS, SIZES


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


def test_a_case_that_cannot_be_had_is_not_made(monkeypatch, tmp_path):
    monkeypatch.setattr("crashkit.testing.concealed.draft._try", lambda *_: None)
    assert make(Ticket("case_0001", (1, 1), ("tension",), "gross"), tmp_path) is None
