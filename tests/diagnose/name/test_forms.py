"""A finding in a poor form is told in a better one, which leaves no room for what made up for it."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.from_given import FromGiven
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import forms
from crashkit.diagnose.name.follow import reconsidered
from crashkit.diagnose.name.forms import in_best_forms
from crashkit.diagnose.name.look import LEAST_DROP, Look
from crashkit.diagnose.name.rivals import further_rivals, nearest_rivals
from crashkit.diagnose.show.run_drops import run_drops
from crashkit.model import Parameter
from crashkit.model.edit import with_factor
from crashkit.protocols import Proposal

POWER = {"rate_amplitude": 0.25, "rate_exponent": 0.25}
BOTH_WAYS = {"rate_amplitude": 0.12, "reference_rate": 0.3}


def silent(doing, share):
    """Nobody listens."""


@pytest.fixture
def base(workshop, model, misfit, recorded):
    """The best fit of a model without a rate effect to three runs of one that has it."""

    def fit(factor, numbers):
        true = with_factor(model, "first", factor, {name: Parameter(v, fixed=True) for name, v in numbers.items()})
        given = misfit(model, slow=recorded(true, 0.6, 1), middle=recorded(true, 1.0, 2), fast=recorded(true, 1.8, 3))
        return begin(workshop.identifier, given).advance(40)

    return fit


@pytest.fixture
def proposed(workshop):
    """All forms of a physics beside a fit."""

    def propose(search, physics):
        fitted = search.fitted()
        motion = [fitted.predictor.motion(run, fitted.values(fitted.start())) for run in fitted.recordings]
        return workshop.hypotheses[physics]().propose(fitted.model, motion, list(fitted.recordings.values()))

    return propose


@pytest.fixture
def finding(workshop, proposed):
    """A physics in one form, fitted beside what there is."""

    def find(search, physics, form):
        proposal = next(one for one in proposed(search, physics) if one.form == form)
        start = workshop.misfit(search.fitted(), proposal.model).with_values({proposal.parameters[0]: 0.01})
        found = begin(workshop.identifier, start).advance(60)
        drop = search.deviance - found.deviance
        return Look((Rival(proposal, found, drop, 0.5 * drop),), (1.0,), 0.0, search.fitted())

    return find


def test_a_better_form_takes_the_place_of_a_poor_one(inquiry, base, finding):
    without = base("rate_power", POWER)
    look = finding(without, "rate_dependence", "linear")
    poor = look.leader.search
    (better,), search = in_best_forms(inquiry(without), [look], poor)
    assert poor.normalised > 1.05
    assert better.leader.proposal.form == "power"
    assert better.leader.search is search
    assert search.normalised == pytest.approx(1.0, abs=0.03)
    assert better.leader.drop == pytest.approx(without.deviance - search.deviance)
    values = search.misfit.values(search.point)
    assert values["joint.first.rate_exponent"] == pytest.approx(POWER["rate_exponent"], abs=0.1)


def test_a_better_form_is_fitted_to_the_instruments_that_its_look_was_made_at(inquiry, base, finding, workshop):
    """An accelerometer that was set aside is believed again once what is wrong with it is known."""
    without = base("rate_power", POWER)
    films = {run: tree.drop_nodes("accelerometer") for run, tree in without.misfit.recordings.items()}
    aside = begin(workshop.identifier, workshop.first_misfit(without.fitted().model, films)).advance(40)
    look = finding(aside, "rate_dependence", "linear")
    (better,), search = in_best_forms(inquiry(without), [look], finding(without, "rate_dependence", "linear").leader.search)
    seen = better.leader.search.misfit
    assert better.leader.proposal.form == "power"
    assert [channel.name for channel in seen.channels] == [channel.name for channel in better.before.channels]
    assert len(search.misfit.channels) == 2 * len(seen.channels)
    drops = run_drops(better.before, better.leader.search.fitted())
    assert sum(drops.values()) == pytest.approx(aside.deviance - better.leader.search.deviance)


def test_a_form_that_leaves_nothing_is_not_questioned(inquiry, base, finding):
    without = base("rate_power", POWER)
    look = finding(without, "rate_dependence", "power")
    unwatched = evolve(inquiry(without), progress=pytest.fail)
    assert in_best_forms(unwatched, [look], look.leader.search) == ([look], look.leader.search)


def test_forms_are_asked_once_for_a_fit(inquiry, base, finding):
    without = base("rate_power", POWER)
    asked, look = inquiry(without), finding(without, "rate_dependence", "linear")
    findings, search = in_best_forms(asked, [look], look.leader.search, thorough=True)
    unwatched = evolve(asked, progress=pytest.fail)
    assert in_best_forms(unwatched, findings, search, thorough=True) == (findings, search)
    with pytest.raises(pytest.fail.Exception, match="fitting all forms of rate_dependence"):
        in_best_forms(unwatched, findings, evolve(search), thorough=True)


@pytest.mark.parametrize(
    ("left", "then", "told", "asked"),
    [(11.0, 5.0, 2.0, ["power", "branch"]), (11.0, 9.0, 9.0, ["power"]), (-0.02, -0.03, -0.03, ["power"])],
)
def test_where_a_form_has_moved_all_numbers_they_are_asked_again_from_there(monkeypatch, left, then, told, asked):
    """One that leaves less than half lets others fit that were caught beside the poor one; not at the noise, though numbers
    are strained."""

    def leaving(excess):
        misfit = SimpleNamespace(independent_samples=1000.0, channels=(), is_strained=lambda point: True)
        normalised = (1.0 + excess) ** 0.5
        return SimpleNamespace(excess=excess, normalised=normalised, deviance=1000.0 * excess, misfit=misfit, point=None)

    def form(name):
        return Proposal("relaxation", name, {"joint": "nose"}, None, (), {})

    ends, forms_asked = {"power": ("branch", then), "branch": ("two branches", 2.0)}, []

    def in_all_forms(inquiry, rival, others, search):
        forms_asked.append(rival.proposal.form)
        name, left = ends[rival.proposal.form]
        return [Candidate(form(name), leaving(left))]

    monkeypatch.setattr(forms, "in_all_forms", in_all_forms)
    monkeypatch.setattr(forms, "begun_from_given", lambda search, given: search)
    monkeypatch.setattr(forms, "_as_seen", lambda workshop, look, rival: rival)
    look = Look((Rival(form("power"), leaving(left), 9000.0, 4500.0),), (1.0,), 0.0, None)
    _, search = in_best_forms(SimpleNamespace(given=None, workshop=None), [look], look.leader.search)
    assert search.excess == told
    assert forms_asked == asked


def test_a_fine_form_waits_until_a_plain_one_leaves_something(workshop, base, proposed):
    for factor, numbers, is_tried in (("rate_power", POWER, False), ("rate_eyring", BOTH_WAYS, True)):
        without = base(factor, numbers)
        fitted = without.fitted()
        proposals = proposed(without, "rate_dependence")
        nearest, _ = nearest_rivals(workshop, fitted, proposals, lambda _: LEAST_DROP, silent)
        claims = FromGiven(workshop, fitted, [one for one in proposals if not one.refined], silent)
        ranked = further_rivals(workshop, fitted, claims, proposals, nearest, True, silent).rivals
        told = [rival for rival in ranked if not rival.proposal.refined]
        assert (min(rival.search.normalised for rival in told) > 1.05) is is_tried
        assert any(rival.proposal.form == "both ways" for rival in ranked) is is_tried


def test_what_made_up_for_a_poor_form_is_dropped(inquiry, base, finding):
    without = base("rate_eyring", BOTH_WAYS)
    first = finding(without, "rate_dependence", "logarithm")
    second = finding(first.leader.search, "fracture", "compression")
    both = second.leader.search
    assert both.deviance < first.leader.search.deviance - 20.0
    (kept,), search = reconsidered(inquiry(without), [first, second], both)
    assert kept.leader.proposal.form == "both ways"
    assert search.normalised == pytest.approx(1.0, abs=0.03)


def test_only_the_forms_that_leave_least_are_searched_for_further(monkeypatch):
    """The best start of a form counts for it."""
    costs = {"a": [9.0, 1.0], "b": [2.0], "c": [3.0], "d": [4.0], "e": [5.0]}
    starts = [(SimpleNamespace(form=form), {"cost": cost}) for form, each in costs.items() for cost in each]
    monkeypatch.setattr(forms, "spread", lambda function, items, told: [told(0), *map(function, items)][1:])
    monkeypatch.setattr(forms, "_alone", lambda workshop, origin, present, start: [(start[1], start[1]["cost"])])
    monkeypatch.setattr(forms, "_by_and_by", lambda workshop, origin, start, ends: [*ends, ({"further": 0.0}, 0.0)])
    shares = []
    ends = forms._ahead(None, None, None, starts, shares.append)
    assert ends == 5 * [{"further": 0.0}] + [{"cost": 5.0}]
    assert shares == [0.0, 0.5]
