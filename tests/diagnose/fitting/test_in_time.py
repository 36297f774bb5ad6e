"""Questions end when the time is up, and what was found by then is told."""

import math

import pytest
from attrs import evolve

from crashkit.diagnose import diagnose, diagnosis
from crashkit.diagnose.fitting import in_time
from crashkit.diagnose.fitting.in_time import OutOfTimeError, TimeLimit, sooner
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint


@pytest.fixture
def clock(monkeypatch):
    """A clock that only moves when it is told to."""

    class Clock:
        now = 0.0

    monkeypatch.setattr(in_time, "monotonic", lambda: Clock.now)
    return Clock


@pytest.fixture
def damped(workshop, model, recorded):
    """The diagnosis of a model without the dashpot that the recordings have, with so many seconds for questions."""
    numbers = {"damping": 800.0, "clearance": 0.0, "engagement": 1e-3}
    dashpot = Joint("dashpot", ("wall", "front"), "viscous", {n: Parameter(v, fixed=True) for n, v in numbers.items()})
    believed = model.with_values({path: 1.08 * p.value for path, p in model.free_parameters().items()})
    rivals = ("bias", "clearance", "gain_error", "viscous_damping")
    few = evolve(workshop, hypotheses={name: workshop.hypotheses[name] for name in rivals})
    runs = {name: recorded(with_joint(model, dashpot), speed, seed) for name, speed, seed in RUNS}
    faster = {"faster.nc": recorded(with_joint(model, dashpot), 1.3, 3)}

    def run(seconds, progress, is_held_out=False):
        return diagnose(believed, runs, faster if is_held_out else {}, few, progress, seconds)

    return run


RUNS = (("slow.nc", 0.9, 1), ("fast.nc", 1.2, 2))


def test_what_is_asked_first_leaves_time_for_what_is_asked_next(clock):
    limit = TimeLimit(10.0, lambda doing, share: None)
    limit("first", 0.0)
    clock.now = 2.0
    part = sooner(limit, 0.5)
    clock.now = 4.0
    part("early", 0.0)
    clock.now = 6.0
    with pytest.raises(OutOfTimeError, match="^$"):
        part("late", 0.0)
    assert limit.is_over
    limit("next", 0.0)
    clock.now = 11.0
    with pytest.raises(OutOfTimeError, match="^$"):
        limit("after", 0.0)


def test_a_part_begins_a_limit_and_what_has_no_limit_has_no_part(clock):
    limit = TimeLimit(10.0, lambda doing, share: None)
    part = sooner(limit, 0.5)
    clock.now = 11.0
    for one in (part, limit):
        with pytest.raises(OutOfTimeError, match="^$"):
            one("late", 0.0)
    unlimited = print
    assert sooner(unlimited, 0.5) is unlimited


def test_a_question_after_the_time_is_not_answered(clock):
    told = []
    limit = TimeLimit(2.0, lambda doing, share: told.append(doing))
    limit("first", 0.0)
    clock.now = 2.5
    with pytest.raises(OutOfTimeError):
        limit("second", 0.0)
    assert told == ["first"]
    assert limit.is_over


def test_the_time_begins_with_the_first_question(clock):
    limit = TimeLimit(1.0, lambda doing, share: None)
    clock.now = 5.0
    limit("first", 0.0)
    clock.now = 5.9
    limit("second", 0.0)
    assert not limit.is_over


def test_what_stands_without_an_answer(clock):
    def question(limit):
        limit("asking", 0.0)
        return "answer"

    assert in_time.in_time("none", question, TimeLimit(1.0, lambda doing, share: None)) == "answer"
    limit = TimeLimit(1.0, lambda doing, share: None)
    limit("a first question", 0.0)
    clock.now = 3.0
    assert in_time.in_time("none", question, limit) == "none"


def test_without_time_nothing_is_found_and_the_answer_says_why(clock, damped):
    def later(doing, share):
        clock.now += 1.0

    answer = damped(1e-3, later)
    assert answer.findings == ()
    assert answer.verdict == "unexplained"
    assert "the time for questions was up after 0 s" in answer.notes[0]
    assert answer.notes[0] in answer.summary


def test_what_was_found_before_is_told(clock, damped):
    told = []

    def ends_with_the_second_look(doing, share):
        told.append(doing.split()[0])
        clock.now += "fitting" in told and told[-1] == "scoring"

    answer = damped(0.5, ends_with_the_second_look)
    assert [finding.physics for finding in answer.findings] == ["viscous_damping"]
    assert "the time for questions was up" in answer.summary


def test_where_all_is_asked_again_and_the_time_ends_that_the_first_answer_stands(clock, damped, monkeypatch):
    monkeypatch.setattr(diagnosis, "fitted_together", lambda workshop, discovery, *_: discovery.search)
    monkeypatch.setattr(diagnosis, "asks_again", lambda *_: True)
    told = []

    def ends_with_the_second_asking(doing, share):
        told.append(doing)
        clock.now += told.count("re-identifying the model") == 2

    answer = damped(0.5, ends_with_the_second_asking, is_held_out=True)
    assert told.count("re-identifying the model") == 2
    assert [finding.physics for finding in answer.findings] == ["viscous_damping"]
    assert answer.fits["holdout"]["after"].normalised_rmse < 1.2
    assert "the time for questions was up" in answer.summary


def test_where_the_second_asking_explains_everything_when_the_time_ends_it_stands(clock, damped, monkeypatch):
    monkeypatch.setattr(diagnosis, "fitted_together", lambda workshop, discovery, *_: discovery.search)
    monkeypatch.setattr(diagnosis, "asks_again", lambda *_: True)
    asked, discovered_in = [], diagnosis._discovered_in

    def ends_with_the_last_question(workshop, model, recordings, limit, *looks):
        asked.append(sorted(recordings))
        found = discovered_in(workshop, model, recordings, limit, *looks)
        if len(asked) == 2:
            limit.end()
        return found

    monkeypatch.setattr(diagnosis, "_discovered_in", ends_with_the_last_question)
    answer = damped(0.5, lambda doing, share: None, is_held_out=True)
    assert len(asked[0]) < len(asked[1])
    assert [finding.physics for finding in answer.findings] == ["viscous_damping"]
    assert "it was fitted too" in answer.summary and not answer.fits["holdout"]
    assert "the time for questions was up" in answer.summary


def test_without_a_limit_everything_is_asked(clock, damped):
    def slowly(doing, share):
        clock.now += 1e6

    answer = damped(math.inf, slowly)
    assert [finding.physics for finding in answer.findings] == ["viscous_damping"]
    assert "the time for questions" not in answer.summary
