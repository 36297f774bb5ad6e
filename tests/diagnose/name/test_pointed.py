"""Where an estimate leaves less than a known cause elsewhere, the known causes of its place are asked beside it."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.evidence import by_evidence, ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import pointed
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.pointed import with_better_pointed_to, with_causes_pointed_to
from crashkit.testing import toys

ELSEWHERE, GAP, TABLE = ("joint_friction", "joint first"), ("clearance", "joint second"), ("unknown", "joint second")


@pytest.fixture(scope="module")
def asked(workshop, inquiry, misfit, recorded):
    """Of a model that lacks a gap in its second joint, an inquiry, and what friction in the first explains, and an estimated
    force in the second."""
    two = toys.two_degrees()
    loose = next(p for p in propose_all(workshop, misfit(two, run=recorded(two))) if identity(p) == GAP)
    (path,) = loose.parameters
    true = loose.model.with_parameters({path: evolve(loose.model.parameters()[path], value=0.003)})
    given = misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
    base = begin(workshop.identifier, given).advance(60)
    claims = [p for p in propose_all(workshop, base.fitted()) if identity(p) in (ELSEWHERE, TABLE) and not p.refined]
    starts = [workshop.misfit(base.fitted(), p.model).with_values(p.starts[0]) for p in claims]
    fits = [(p, begin(workshop.identifier, start).advance(40)) for p, start in zip(claims, starts, strict=True)]
    rivals = ranked_by_evidence(fits, base.deviance)
    table = min((one for one in rivals if one.identity == TABLE), key=lambda one: one.search.deviance)
    rubbing = next(one for one in rivals if one.identity == ELSEWHERE)
    return inquiry(base, given=given), Look.of(by_evidence([table, rubbing]), base.fitted())


def test_the_cause_that_an_estimate_points_to_is_found(asked):
    inquiry, look = asked
    found = with_causes_pointed_to(inquiry, look)
    assert found.leader.identity == GAP
    assert found.leader.search.normalised == pytest.approx(1.0, abs=0.05)
    assert {rival.identity for rival in look.rivals} <= {rival.identity for rival in found.rivals}


def test_where_the_known_cause_leaves_much_an_estimate_points_that_leaves_next_to_nothing(asked, monkeypatch):
    monkeypatch.setattr(pointed, "CONCEALED", 1.0)
    inquiry, look = asked
    assert with_causes_pointed_to(inquiry, look).leader.identity == GAP


def test_nothing_is_asked_where_both_leave_much(asked, monkeypatch):
    """The known cause may be in a form that is off, or another is missing."""
    monkeypatch.setattr(pointed, "CONCEALED", 1.0)
    monkeypatch.setattr(pointed, "FAR_LESS", -1.0)
    inquiry, look = asked
    assert with_causes_pointed_to(inquiry, look) is look


@pytest.mark.parametrize("physics", [TABLE, ELSEWHERE])
def test_nothing_is_asked_where_there_is_no_other_claim_to_compare(asked, physics):
    inquiry, look = asked
    alone = Look.of([rival for rival in look.rivals if rival.identity == physics], look.before)
    assert with_causes_pointed_to(inquiry, alone) is alone


def test_nothing_is_asked_where_an_estimate_gains_no_more_than_chance(asked, monkeypatch):
    monkeypatch.setattr(pointed, "BY_CHANCE", float("inf"))
    inquiry, look = asked
    assert with_causes_pointed_to(inquiry, look) is look


def test_nothing_is_asked_where_the_estimate_leaves_something_itself(asked, monkeypatch):
    monkeypatch.setattr(pointed, "UNEXPLAINED", 0.5)
    inquiry, look = asked
    assert with_causes_pointed_to(inquiry, look) is look


def told_in_its_best_form(look):
    return next(rival.search for rival in look.rivals if rival.identity == ELSEWHERE)


def test_beside_a_finding_the_cause_is_found_that_an_estimate_points_to(asked, monkeypatch):
    monkeypatch.setattr(pointed, "CONCEALED", 1.0)
    inquiry, look = asked
    assert with_better_pointed_to(inquiry, look, told_in_its_best_form(look)).leader.identity == GAP


@pytest.mark.parametrize("changed", [("CONCEALED", 99.0), ("LESS", -99.0)])
def test_beside_a_finding_nothing_is_asked_where_what_is_told_leaves_little_or_the_estimate_hardly_less(
    asked, monkeypatch, changed
):
    monkeypatch.setattr(pointed, "CONCEALED", 1.0)
    monkeypatch.setattr(pointed, *changed)
    inquiry, look = asked
    assert with_better_pointed_to(inquiry, look, told_in_its_best_form(look)) is look


def test_beside_a_finding_nothing_is_asked_where_nothing_is_estimated(asked):
    inquiry, look = asked
    alone = Look.of([rival for rival in look.rivals if rival.identity == ELSEWHERE], look.before)
    assert with_better_pointed_to(inquiry, alone, told_in_its_best_form(look)) is alone
