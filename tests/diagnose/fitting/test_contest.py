"""Which claims go on: estimated tables leave room for known causes, and the better of two quick searches counts."""

from types import SimpleNamespace

import numpy as np
import pytest

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.contest import GROWING, heats, scores, scouted
from crashkit.diagnose.result import UNKNOWN
from crashkit.errors import SimulationError
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Proposal


def candidate(physics, cost, numbers=()):
    """A claim whose search of a thousand samples stands still."""
    misfit = SimpleNamespace(independent_samples=1000.0, channels=())
    search = SimpleNamespace(state=SimpleNamespace(cost=cost), misfit=misfit, settled=True, advance=lambda steps: search)
    return Candidate(Proposal(physics, "", {"joint": "front"}, None, numbers, {}), search)


def ahead(candidates, size, monkeypatch):
    monkeypatch.setattr("crashkit.diagnose.fitting.candidates.advance_all", lambda searches, steps, told: searches)
    return [(p.physics, search.state.cost) for p, search in heats(candidates, ((size, 1),), lambda doing, share: None)]


def test_estimated_tables_take_half_of_the_places_at_most(monkeypatch):
    """Two dozen heights fit better than the law that is missing, and explain less."""
    tables, named = (
        [candidate(UNKNOWN, cost) for cost in (1.0, 2.0, 3.0)],
        [candidate("fracture", cost) for cost in (9.0, 8.0, 7.0)],
    )
    best = [("fracture", 7.0), ("fracture", 8.0), (UNKNOWN, 1.0), (UNKNOWN, 2.0)]
    assert ahead([*tables, *named], 4, monkeypatch) == best


def test_numbers_that_explain_nothing_more_cost_a_place(monkeypatch):
    """A load on a stiff tie moves like a mass that is wrong."""
    tied = [candidate("carried_load", cost, ("mass", "stiffness", "damping")) for cost in (90.0, 91.0)]
    assert ahead([*tied, candidate("added_mass", 95.0, ("mass",))], 1, monkeypatch)[0] == ("added_mass", 95.0)
    assert ahead([*tied, candidate("added_mass", 98.0, ("mass",))], 1, monkeypatch)[0] == ("carried_load", 90.0)


def test_one_claim_takes_half_of_the_places_and_what_others_leave(monkeypatch):
    """In a better form another one may be ahead of it."""
    forms = [candidate("rate_dependence", cost) for cost in (1.0, 2.0, 3.0)]
    others = [candidate("relaxation", cost) for cost in (8.0, 9.0)]
    assert ahead([*others, *forms], 2, monkeypatch) == [("rate_dependence", 1.0), ("relaxation", 8.0)]
    best = [("rate_dependence", 1.0), ("rate_dependence", 2.0), ("relaxation", 8.0), ("relaxation", 9.0)]
    assert ahead([*others, *forms], 4, monkeypatch) == best
    assert ahead([*others[:1], *forms], 4, monkeypatch) == [*best[:3], ("rate_dependence", 3.0)]


@pytest.mark.parametrize("physics", [UNKNOWN, "fracture"])
def test_places_that_nobody_else_wants_are_not_lost(monkeypatch, physics):
    candidates = [candidate(physics, cost) for cost in (3.0, 1.0, 2.0)]
    expected = [1.0, 2.0] if physics == UNKNOWN else [1.0, 2.0, 3.0]
    assert [cost for _, cost in ahead(candidates, 4, monkeypatch)] == expected


def test_claims_that_are_scored_from_the_given_values_begin_there(workshop, model, misfit, recorded):
    """They are built on the re-identified model, whose numbers may hide what is missing."""
    given = misfit(model, run=recorded(model))
    driven = given.with_values({"joint.first.crush_force": 3e4})
    proposals = [p for p in propose_all(workshop, driven) if p.physics == "clearance"]
    equipped = workshop.equipped([p.model for p in proposals])
    found = scores(equipped, given, proposals, np.inf, lambda doing, share: None)
    own = {name: value for name, value in given.values(given.start()).items() if "clearance" not in name}
    assert found
    assert all({name: one.values[name] for name in own} == pytest.approx(own) for _, one in found)


@pytest.fixture
def scouts(workshop, model, misfit, recorded):
    """What each of some claims leaves where its scout ends."""
    given = misfit(model.with_values({"joint.first.crush_force": 3e4}), run=recorded(model))
    proposals = [p for p in propose_all(workshop, given) if p.physics in ("clearance", "viscous_damping")]
    equipped = workshop.equipped([p.model for p in proposals])
    starts = [(p, dict(p.starts[0])) for p in proposals]

    def send(shares, astray):
        ends = scouted(equipped, given, starts, shares, len(starts), astray, lambda doing, share: None)
        return np.array([_coarse_cost(equipped, given, p, s) for p, s in sorted(ends, key=lambda one: id(one[0]))])

    return send


def test_a_scout_that_went_astray_ends_no_worse_than_one_that_sees_all_the_time_from_the_start(scouts):
    """Growing shares of the time lead past thresholds, but now and then astray."""
    assert np.all(scouts(GROWING, astray=0.0) <= scouts((1.0, 1.0), astray=0.0) * (1.0 + 1e-9))


def test_a_scout_that_found_its_way_does_not_go_another(scouts):
    grown, both = scouts(GROWING, astray=np.inf), scouts(GROWING, astray=0.0)
    assert np.all(both <= grown)
    assert np.any(both < grown)


def _coarse_cost(workshop, given, proposal, search):
    coarse = workshop.misfit(given.coarse, proposal.model)
    return float(np.sum(coarse.residual(search.point) ** 2))


def test_nothing_is_proposed_from_numbers_with_which_the_model_blows_up(workshop, model, misfit, recorded):
    """The equations of motion may lead a claim there, along a motion that it would never make."""
    damping = {"damping": Parameter(1e9, fixed=True), "exponent": Parameter(3.0, fixed=True)}
    stiff = with_joint(model, Joint("dashpot", ("wall", "front"), "viscous_power", damping))
    wild = workshop.equipped([stiff]).misfit(misfit(model, run=recorded(model)), stiff)
    with pytest.raises(SimulationError, match="the force of joint .* at t = .* s is not finite"):
        wild.residual(wild.start())
    assert propose_all(workshop, wild) == []
