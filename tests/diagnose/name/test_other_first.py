"""Where the first finding leads nowhere, another beginning may; only if two then fit better."""

from types import SimpleNamespace

import pytest

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.name import other_first
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import UNKNOWN
from crashkit.protocols import Proposal


def rival(physics, form, deviance):
    misfit = SimpleNamespace(independent_samples=1000.0)
    search = SimpleNamespace(deviance=deviance, normalised=1.5, excess=1.25, misfit=misfit, fitted=lambda: None)
    drop = 9000.0 - deviance
    return Rival(Proposal(physics, form, {"joint": "front"}, None, ("a",), {}), search, drop, 0.5 * drop)


def won_by(*rivals, nothing=0.0):
    return Look(rivals, (1.0,) + (0.0,) * (len(rivals) - 1), nothing, None)


FIRST = won_by(rival("plastic_unloading", "fading", 3000.0), rival("fracture", "compression", 5000.0))
NOTHING = won_by(rival("bias", "constant", 1900.0), nothing=1.0)
RELAXATION = won_by(rival("relaxation", "maxwell", 900.0))
FORMS = [rival("plastic_unloading", form, deviance) for form, deviance in (("fading", 3000.0), ("line", 4000.0))]


@pytest.fixture
def begun(monkeypatch, inquiry):
    """The first finding and the second of another beginning, where these are the looks beside each."""

    def ask(beside, least=2000.0):
        def look(inquiry, current, found, quick):
            assert quick
            return beside[(found[0].proposal.physics, found[0].proposal.form)]

        monkeypatch.setattr(other_first, "look_again", look)
        monkeypatch.setattr(other_first, "in_all_forms", lambda *_: [(one.proposal, one.search) for one in FORMS])
        found = other_first.begun_otherwise(inquiry(None), FIRST, least)
        return found and [(one.leader.proposal.physics, one.leader.proposal.form) for one in found]

    return ask


def test_another_form_beside_which_a_second_effect_shows(begun):
    beside = {("plastic_unloading", "line"): RELAXATION, ("fracture", "compression"): NOTHING}
    assert begun(beside) == [("plastic_unloading", "line"), ("relaxation", "maxwell")]


def test_another_claim(begun):
    beside = {("plastic_unloading", "line"): NOTHING, ("fracture", "compression"): won_by(rival("peak_load", "bump", 1500.0))}
    assert begun(beside) == [("fracture", "compression"), ("peak_load", "bump")]


@pytest.mark.parametrize("second", [NOTHING, won_by(rival(UNKNOWN, "time", 900.0)), won_by(rival("bias", "constant", 2100.0))])
def test_what_fits_no_better_is_left(begun, second):
    assert begun({("plastic_unloading", "line"): second, ("fracture", "compression"): NOTHING}) is None
