"""Two leading causes are put beside each other where one alone leaves much, and told where they leave next to nothing."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.couples import Couple
from crashkit.diagnose.name import nearby
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.nearby import _two_leaders


def leaving(normalised):
    return SimpleNamespace(normalised=normalised, excess=normalised**2 - 1.0)


@pytest.fixture
def two(monkeypatch):
    """Whether two leaders are told that leave so much, where the best of them alone leaves so much; and whether they were
    asked for."""
    asked = []

    def told(alone, together):
        couples = [Couple(None, None, leaving(left)) for left in together]
        monkeypatch.setattr(nearby, "coupled_leaders", lambda inquiry, look: asked.append(alone) or couples)
        monkeypatch.setattr(nearby, "both", lambda inquiry, look: (look, evolve(look, couples=())))
        monkeypatch.setattr(nearby, "followed", lambda inquiry, begun, look: (begun[0].couples, look))
        found = _two_leaders(None, Look((), (), 1.0, None), leaving(alone))
        return [couple.search.normalised for couple in found] if found else None

    told.asked = asked
    return told


def test_two_leaders_that_leave_next_to_nothing_are_followed(two):
    assert two(3.0, [1.05, 1.1]) == [1.05, 1.1]


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
def test_else_they_are_not_followed(two, alone, together, why):
    assert two(alone, together) is None, why
    assert two.asked == [alone]
