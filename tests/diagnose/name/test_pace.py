"""What is found may outrun the recordings as they were thinned: it is then judged by finer ones."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose import diagnosis
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.in_time import OutOfTimeError
from crashkit.diagnose.name import pace
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.inquiry import Inquiry
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.pace import OutrunError, check_pace, check_rate
from crashkit.protocols import Proposal


def leaving(normalised, misfit=None):
    """A fit that leaves so much."""
    return SimpleNamespace(normalised=normalised, excess=normalised**2 - 1.0, misfit=misfit, fitted=lambda: misfit)


def claim(normalised, physics="joint_friction"):
    """A claim whose fit leaves so much."""
    search = leaving(normalised, SimpleNamespace(model=None, independent_samples=2000.0))
    return Rival(Proposal(physics, "", {"joint": "front"}, None, (), {}), search, 1000.0, 500.0)


@pytest.fixture
def finer(monkeypatch):
    """An inquiry into recordings that, thinned in the light of any claim, leave so much of it."""

    def finer(normalised, recorded=("run",), bears=True):
        monkeypatch.setattr(pace, "sharpened", lambda *_: leaving(normalised))
        monkeypatch.setattr(pace, "bears_step", lambda misfit: bears)
        return SimpleNamespace(
            workshop=SimpleNamespace(equipped=lambda models: None), given=SimpleNamespace(model=None), unthinned=recorded
        )

    return finer


@pytest.mark.parametrize(("left", "then"), [(1.16, 1.01), (1.04, 1.0)])
def test_a_claim_that_finer_recordings_explain_has_outrun_the_others(finer, left, then):
    """Where it leaves more than chance would: of two thousand samples that is 1.03."""
    with pytest.raises(OutrunError, match="joint_friction") as caught:
        check_pace(finer(then), claim(left))
    assert caught.value.found.search.normalised == then


def test_a_claim_for_which_steps_are_too_long_is_judged_in_shorter_ones(finer):
    with pytest.raises(OutrunError, match="joint_friction") as caught:
        check_pace(finer(1.16, bears=False), claim(1.16))
    assert caught.value.found.search.normalised == 1.16


@pytest.mark.parametrize(
    ("left", "then", "physics", "recorded"),
    [
        (1.16, 1.13, "joint_friction", ("run",)),
        (1.03, 1.0, "joint_friction", ("run",)),
        (1.16, 1.01, "unknown", ("run",)),
        (1.16, 1.01, "joint_friction", ()),
    ],
)
def test_a_claim_goes_on(finer, left, then, physics, recorded):
    """Which leaves as much of finer recordings, is at the noise, is an estimate, or for which there are no finer ones."""
    check_pace(finer(then, recorded), claim(left, physics))


@pytest.mark.parametrize(("finer", "kept", "is_outrun"), [(400, ("run",), True), (200, ("run",), False), (400, (), False)])
def test_readings_that_need_more_samples_than_there_are_outrun_them(
    workshop, model, misfit, recorded, monkeypatch, finer, kept, is_outrun
):
    """However much a claim leaves; where there are finer recordings."""
    few, more = (recorded(model, accelerometer=lambda group, n=n: group.isel(time=slice(n))) for n in (200, finer))
    search = pace.begin(workshop.identifier, misfit(model, run=few))
    found = Rival(Proposal("mounting_resonance", "", {"sensor": "s"}, model, (), {}), search, 1000.0, 500.0)
    monkeypatch.setattr(pace, "in_the_light_of", lambda *_: misfit(model, run=more))
    there = SimpleNamespace(workshop=workshop, given=search.misfit, unthinned=kept)
    if not is_outrun:
        check_rate(there, found)
        return
    with pytest.raises(OutrunError, match="mounting_resonance") as caught:
        check_rate(there, found)
    assert caught.value.found.search.misfit.sample_count > search.misfit.sample_count


@pytest.mark.parametrize(("is_answered", "left"), [(True, 1.0), (True, 1.2), (False, 1.0)])
def test_all_is_asked_again_of_finer_recordings_and_the_claim_stands_where_time_is_up(
    workshop, model, misfit, recorded, monkeypatch, is_answered, left
):
    """Or where all that was found in time leaves more."""
    given = misfit(model, run=recorded(model))
    base = diagnosis.begin(workshop.identifier, given)
    first, found = (
        Rival(Proposal(physics, "", {"joint": "first"}, model, (), {}), base, 1000.0, 500.0)
        for physics in ("clearance", "joint_friction")
    )
    beside = [Look((first,), (1.0,), 0.0, base.fitted())]
    asked = []

    def discover(inquiry, looks, stand=False):
        asked.append((inquiry.unthinned, [rival for look in looks for rival in look.rivals], stand))
        if len(asked) == 1:
            raise OutrunError(found, beside)
        if not is_answered:
            raise OutOfTimeError
        search = SimpleNamespace(normalised=left)
        return Discovery(base.fitted(), base.fitted(), search, (Look((evolve(found, drop=1.0),), (1.0,), 0.0, base.fitted()),))

    monkeypatch.setattr(diagnosis, "discover", discover)
    told = diagnosis._discovered_at_pace(Inquiry(workshop, given, base, None, {"run": recorded(model)}), [])
    assert asked == [({"run": asked[0][0]["run"]}, [], False), ({}, [first, found], True)]
    assert [look.leader.drop for look in told.findings] == ([1.0] if is_answered and left == 1.0 else [1000.0, 1000.0])


@pytest.mark.parametrize(("location", "is_asked"), [({"sensor": "s", "instrument": "a"}, True), ({"joint": "front"}, False)])
def test_readings_at_the_noise_may_outrun_what_was_thinned_too(monkeypatch, finer, location, is_asked):
    """What rings is hardly seen in means: what is left of it looks like more, even where nothing seems to be left."""
    asked = []
    monkeypatch.setattr(pace, "check_rate", lambda inquiry, found, beside: asked.append(found))
    told = claim(1.01)
    check_pace(finer(1.0), evolve(told, proposal=evolve(told.proposal, location=location)))
    assert bool(asked) is is_asked
