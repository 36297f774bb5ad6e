"""Two leading causes are put beside each other where one alone leaves much, and told where they leave next to nothing."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.name import nearby
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.nearby import _two_at_once


def leaving(normalised):
    return SimpleNamespace(normalised=normalised, excess=normalised**2 - 1.0)


@pytest.fixture
def two(monkeypatch):
    """Whether two causes are told that leave so much, as the leaders, as two places, and as all do, where the best of them
    alone leaves so much; and who was asked for."""
    asked = []

    def answering(name, left):
        couples = [Couple(None, None, leaving(one)) for one in left]
        return lambda *_: asked.append(name) or couples

    def told(alone, leaders, places=(), everyone=(), base=9.0):
        for name, left in {
            "coupled_leaders": leaders,
            "couples_at_two_places": places,
        }.items():
            monkeypatch.setattr(nearby, name, answering(name, left))
        monkeypatch.setattr(nearby, "both", lambda inquiry, look: (look, evolve(look, couples=())))
        monkeypatch.setattr(nearby, "followed", lambda inquiry, begun, look: (begun[0].couples, look))
        claims = SimpleNamespace(couples=answering("from_given", everyone))
        inquiry = SimpleNamespace(base=leaving(base), from_given=claims)
        found = _two_at_once(inquiry, Look((), (), 1.0, None), leaving(alone))
        return [couple.search.normalised for couple in found] if found else None

    told.asked = asked
    return told


def test_two_leaders_that_leave_next_to_nothing_are_followed(two):
    assert two(3.0, [1.05, 1.1], [1.0], [1.0]) == [1.05, 1.1]
    assert two.asked == ["coupled_leaders"]


def test_they_are_not_asked_for_where_one_alone_leaves_next_to_nothing(two):
    assert two(1.1, [1.0]) is None
    assert two.asked == []


@pytest.mark.parametrize(
    ("alone", "together", "why"),
    [
        (3.0, [1.2], "they leave something"),
        (1.2, [1.13], "they leave hardly less than one alone"),
        (3.0, [], "there are no two"),
    ],
)
def test_else_those_at_two_places_are_and_then_those_of_all(two, alone, together, why):
    assert two(alone, together, [1.01], [1.0]) == [1.01], why
    assert two(alone, together, together, [1.0]) == [1.0], why
    assert two(alone, together, together, together) is None, why
    assert two.asked == ["coupled_leaders", "couples_at_two_places"] + 2 * [
        "coupled_leaders",
        "couples_at_two_places",
        "from_given",
    ]


def test_those_of_all_are_asked_later_where_one_alone_leaves_most(two):
    assert two(3.0, [], [], [1.0], base=3.5) is None
    assert "from_given" not in two.asked
