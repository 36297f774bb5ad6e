"""What held-out runs say of what was found: contradicted, or only told less well."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose import diagnose, diagnosis, holdout
from crashkit.diagnose.holdout import asks_again, says_more
from crashkit.diagnose.result import place_of
from crashkit.protocols import Proposal


def finding(physics, location, *numbers):
    proposal = Proposal(physics, "", location, None, numbers, {})
    return SimpleNamespace(leader=SimpleNamespace(proposal=proposal, place=place_of(location)))


def findings(*told):
    return SimpleNamespace(findings=told)


LAW = finding("bottoming", {"joint": "rail"}, "stiffness", "begin")
CLOCK = finding("clock_offset", {"instrument": "load cell"}, "clock_offset")


@pytest.fixture
def contradicted(monkeypatch):
    """Whether a finding is contradicted where a model without it left so much, and all runs with it leave so much."""
    monkeypatch.setattr(holdout, "normalised", lambda misfit, told_only: misfit if told_only else 1.0)

    def asked(base, together, findings=(LAW,)):
        return asks_again(SimpleNamespace(findings=findings, base=base), SimpleNamespace(fitted=lambda: together))

    return asked


def test_what_leaves_something_of_all_runs_asks_again(contradicted):
    assert contradicted(5.0, 1.3)
    assert not contradicted(5.0, 1.05)


def test_a_trace_of_what_is_gross_contradicts_nothing(contradicted):
    """No further finding could be told for so little."""
    assert not contradicted(18.0, 1.3)
    assert contradicted(18.0, 1.6)
    assert not contradicted(18.0, 1.6, findings=(LAW, CLOCK))
    assert contradicted(18.0, 1.9, findings=(LAW, CLOCK))


def test_one_number_of_an_instrument_has_no_form_that_may_be_off(contradicted, monkeypatch):
    """However gross it was, more than chance leaves of all runs says that something else is missing."""
    for is_at_noise in (False, True):
        monkeypatch.setattr(holdout, "is_at_noise", lambda search, told=is_at_noise: told)
        assert contradicted(18.0, 1.1, findings=(CLOCK,)) != is_at_noise
        assert not contradicted(18.0, 1.1, findings=(LAW,))


def test_where_nothing_was_found_all_runs_are_asked(contradicted):
    """The model's own numbers may hide one cause in all runs, too."""
    assert contradicted(1.0, 1.0, findings=())


def test_what_all_runs_say_no_more_of_leaves_those_held_out_a_test(monkeypatch):
    for is_at_noise in (False, True):
        monkeypatch.setattr(holdout, "is_at_noise", lambda search, told=is_at_noise: told)
        assert says_more(findings(), findings(), SimpleNamespace()) != is_at_noise
        assert says_more(findings(), findings(LAW), SimpleNamespace())


def test_an_estimate_does_not_take_the_place_of_one_of_two_known_causes():
    table = finding("unknown", {"joint": "rail"}, "heights[0]")
    elsewhere = finding("unknown", {"joint": "mount"}, "heights[0]")
    assert not says_more(findings(LAW, CLOCK), findings(table, CLOCK), SimpleNamespace())
    assert says_more(findings(LAW, CLOCK), findings(elsewhere, CLOCK), SimpleNamespace())
    assert says_more(findings(LAW), findings(table), SimpleNamespace())


def test_a_run_that_nothing_explains_better_stays_held_out(workshop, model, recorded, monkeypatch):
    asked, discovered_in = [], diagnosis._discovered_in
    monkeypatch.setattr(diagnosis, "fitted_together", lambda workshop, discovery, *_: discovery.search)
    monkeypatch.setattr(
        diagnosis, "_discovered_in", lambda *arguments: asked.append(sorted(arguments[2])) or discovered_in(*arguments)
    )
    few = evolve(workshop, hypotheses={name: workshop.hypotheses[name] for name in ("bias", "clearance")})
    unseen = {"faster.nc": recorded(model, 1.3, 3)}
    answer = diagnose(model, {"slow.nc": recorded(model, 0.9, 1), "fast.nc": recorded(model, 1.2, 2)}, unseen, few)
    assert asked == [["fast.nc", "slow.nc"], ["fast.nc", "faster.nc", "slow.nc"]]
    assert answer.verdict == "consistent"
    assert answer.fits["holdout"]["after"].normalised_rmse == pytest.approx(1.0, abs=0.1)
    assert "fitted too" not in answer.summary
