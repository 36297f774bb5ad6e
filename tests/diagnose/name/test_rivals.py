"""Which claims a look begins with, and from how many of their starts."""

from types import SimpleNamespace

import pytest

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.score import Score
from crashkit.diagnose.name import rivals
from crashkit.protocols import Proposal


@pytest.fixture
def begun(monkeypatch, workshop, misfit, model, recorded):
    """How many starts of a bias and of bottoming are fitted, of as many that promise something."""
    base = misfit(model, run=recorded(model))
    bias, wall = (propose_all(workshop, base, physics)[0] for physics in ("bias", "bottoming"))

    def ask(count):
        taken = []
        monkeypatch.setattr(rivals, "scouted", lambda workshop, base, starts, *rest: taken.extend(starts) or [])
        monkeypatch.setattr(rivals, "that_may_reach", lambda identifier, base, readings, cost: readings)
        rivals._ahead(workshop, base, [(claim, {}) for claim in (bias, wall) for _ in range(count)], lambda doing, share: None)
        return [sum(claim is one for claim, _ in taken) for one in (bias, wall)]

    return ask


def test_a_claim_about_a_sensor_begins_at_several_starts_and_one_about_the_structure_at_its_best(begun):
    assert begun(3) == [3, 1]


def test_each_begins_at_its_best_where_more_are_asked_than_enter_the_first_heat(begun):
    assert begun(rivals.HEATS[0][0] + 1) == [1, 1]


def test_only_claims_that_are_ahead_in_their_first_forms_are_tried_in_all(monkeypatch):
    """Here of three forms the last leaves least, which the first two do not tell."""
    asked = []

    def scouted(workshop, base, starts, *rest):
        asked.append([proposal.form for proposal, _ in starts])
        ends = [Candidate(claim, SimpleNamespace(state=SimpleNamespace(cost=float(claim.form[1:])))) for claim, _ in starts]
        return sorted(ends, key=lambda one: one.search.state.cost)

    monkeypatch.setattr(rivals, "scouted", scouted)
    monkeypatch.setattr(rivals, "LEADING", 2)
    costs = {"rails": (5, 3, 1), "mounts": (4, 6, 9), "nose": (7, 8, 2)}
    claims = [
        Proposal("clearance", f"{joint[0]}{cost}", {"joint": joint}, None, (), {}) for joint in costs for cost in costs[joint]
    ]
    ends = rivals._in_leading_forms(None, None, [(claim, {}) for claim in claims], 0.0, None)
    assert asked == [["r5", "r3", "m4", "m6", "n7", "n8"], ["r1", "m9"]]
    assert [proposal.form for proposal, _ in ends] == ["r3", "m4", "r5", "m6", "n7", "n8", "r1", "m9"]


@pytest.mark.parametrize(("factor", "is_few", "seen"), [(1.0, False, ["smallest"]), (0.5, True, [])])
def test_where_much_is_left_few_samples_say_where_to_begin_and_no_limits(
    monkeypatch, workshop, misfit, model, recorded, factor, is_few, seen
):
    stiffness = "joint.first.elastic_stiffness"
    off = model.with_values({stiffness: factor * model.parameters()[stiffness].value})
    base, asked = misfit(off, run=recorded(model)), []
    monkeypatch.setattr(rivals, "scores", lambda workshop, origin, *_: asked.append(origin) or [])
    monkeypatch.setattr(rivals, "_ahead", lambda *_: [])
    monkeypatch.setattr(rivals, "heats", lambda *_: [])
    monkeypatch.setattr(rivals, "_limits", lambda scored: ["smallest"])
    _, limits = rivals.nearest_rivals(workshop, base, [], lambda proposal: 20.0, lambda doing, share: None)
    assert (asked[0].sample_count < base.sample_count) is is_few
    assert limits == seen


@pytest.mark.parametrize(("least", "is_begun"), [(20.0, True), (1e5, False)])
def test_nothing_is_fitted_that_would_have_to_explain_more_than_is_left(
    monkeypatch, workshop, misfit, model, recorded, least, is_begun
):
    base, begun = misfit(model, run=recorded(model)), []
    claim = propose_all(workshop, base, "bottoming")[0]
    monkeypatch.setattr(rivals, "scores", lambda *_: [(claim, Score(claim.null, 1e6, 1.0))])
    monkeypatch.setattr(rivals, "_ahead", lambda workshop, base, chosen, progress: begun.extend(chosen) or [])
    _, limits = rivals.nearest_rivals(workshop, base, [], lambda proposal: least, lambda doing, share: None)
    assert bool(begun) is is_begun
    assert [limit.proposal for limit in limits] == [claim]


@pytest.mark.parametrize(
    ("physics", "left", "is_asked"), [("unknown", 1.01, False), ("unknown", 1.3, True), ("peak_load", 1.3, True)]
)
def test_couples_are_asked_from_the_given_numbers_but_where_an_estimate_leaves_nothing(monkeypatch, physics, left, is_asked):
    asked = []
    for name in ("scores", "promising", "scouted", "heats"):
        monkeypatch.setattr(rivals, name, lambda *_: [])
    search = SimpleNamespace(normalised=left, excess=left**2 - 1.0, misfit=SimpleNamespace(independent_samples=1000.0))
    single = Candidate(Proposal(physics, "", {"joint": "nose"}, None, (), {}), search)
    claims = SimpleNamespace(
        workshop=None,
        given=SimpleNamespace(coarse=None),
        progress=None,
        proposals=[],
        ends=[],
        singles=[single],
        couples=lambda least: asked.append(least) or [],
    )
    assert rivals._from_given(claims, 1.0) == ([single], [])
    assert bool(asked) is is_asked
