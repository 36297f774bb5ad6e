"""Two of the causes that lead alone beside each other, and two of all."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.evidence import best_forms, ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import leaders
from crashkit.diagnose.name.leaders import beside_what_gives_way, coupled_leaders, in_other_forms
from crashkit.diagnose.name.look import Look
from crashkit.testing import toys

MASS, GAP = ("added_mass", "body rear"), ("clearance", "joint second")
DAMPER = ("viscous_damping", "joint second")
FREE = ("body.front.mass",)
ASKED = ("added_mass", "clearance", "carried_load", "peak_load", "unknown")


@pytest.fixture(scope="module")
def lacking(workshop, inquiry, misfit, recorded):
    """Of a model whose rear mass is a tenth too small and that lacks what a claim says at these numbers, an inquiry, and what
    those of the claims that are asked explain alone."""
    two = toys.two_degrees()
    two = two.with_parameters({path: evolve(p, fixed=True) for path, p in two.parameters().items() if path not in FREE})
    rear = two.body("rear").mass
    heavy = two.with_parameters({"body.rear.mass": evolve(rear, value=1.1 * rear.value)})

    def looked_at(lacks, form, numbers, is_asked):
        offered = propose_all(workshop, misfit(heavy, run=recorded(heavy)))
        claim = next(p for p in offered if (identity(p), p.form) == (lacks, form))
        known = claim.model.parameters()
        values = {path: evolve(known[path], value=v) for path, v in zip(claim.parameters, numbers, strict=True)}
        true = claim.model.with_parameters(values)
        given = misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
        base = begin(workshop.identifier, given).advance(60)
        claims = [p for p in propose_all(workshop, base.fitted()) if is_asked(p)]
        starts = [workshop.misfit(base.fitted(), p.model).with_values(p.starts[0]) for p in claims]
        fits = [(p, begin(workshop.identifier, start).advance(40)) for p, start in zip(claims, starts, strict=True)]
        return inquiry(base, given=given), Look.of(best_forms(ranked_by_evidence(fits, base.deviance)), base.fitted())

    return looked_at


@pytest.fixture(scope="module")
def asked(lacking):
    """That lacks a gap."""
    return lacking(GAP, "gap", (0.1,), lambda claim: claim.physics in ASKED and not claim.refined)


@pytest.fixture(scope="module")
def damped(lacking):
    """That lacks a damper which grows with the stroke, of which the linear form is asked."""
    plain = {MASS: "constant", DAMPER: "linear"}
    return lacking(DAMPER, "growing with the stroke", (500.0, 0.2), lambda claim: plain.get(identity(claim)) == claim.form)


def test_together_they_leave_nothing_where_each_alone_leaves_much(asked):
    inquiry, look = asked
    best = coupled_leaders(inquiry, look.rivals)[0]
    assert {identity(best.first), identity(best.second)} == {MASS, GAP}
    assert best.search.normalised == pytest.approx(1.0, abs=0.05)
    alone = {rival.identity: rival.search.normalised for rival in look.rivals}
    assert min(alone[MASS], alone[GAP]) > 1.5


def test_no_two_claims_come_twice_nor_one_beside_itself(asked):
    inquiry, look = asked
    couples = coupled_leaders(inquiry, look.rivals)
    claims = [frozenset((identity(couple.first), identity(couple.second))) for couple in couples]
    assert len(set(claims)) == len(claims)
    assert all(len(two) == 2 for two in claims)


def test_a_couple_that_leaves_little_leaves_nothing_in_the_form_that_is_right(damped):
    inquiry, look = damped
    couples = coupled_leaders(inquiry, look.rivals)
    best = in_other_forms(inquiry, couples, look.leader.search)[0]
    assert couples[0].search.normalised > 1.2
    assert best.search.normalised == pytest.approx(1.0, abs=0.05)
    assert {best.first.form, best.second.form} == {"constant", "growing with the stroke, only pushing"}


def test_other_forms_are_not_asked_of_a_couple_that_leaves_much(damped, monkeypatch):
    inquiry, look = damped
    monkeypatch.setattr(leaders, "HOPEFUL", 0.0)
    assert in_other_forms(inquiry, coupled_leaders(inquiry, look.rivals), look.leader.search) == []


def test_an_obstacle_that_gives_way_is_found_beside_a_first_cause(lacking):
    """Nobody saw it move."""
    gives_way = ("obstacle_motion", "body wall")
    numbers = (500.0, 2e5, 3e4, 1e7)
    inquiry, look = lacking(gives_way, "crushing", numbers, lambda claim: identity(claim) == MASS)
    best = beside_what_gives_way(inquiry, look.leader)[0]
    assert look.leader.search.normalised > 2.0
    assert best.search.normalised == pytest.approx(1.0, abs=0.05)
    assert {identity(best.first), identity(best.second)} == {MASS, gives_way}


def test_of_all_causes_those_two_leave_least(asked):
    inquiry, look = asked
    best = inquiry.from_given.couples(look.leader.search.excess)[0]
    assert {identity(best.first), identity(best.second)} == {MASS, GAP}
    assert best.search.normalised == pytest.approx(1.0, abs=0.05)


def test_a_single_leader_has_nothing_beside_it(asked):
    inquiry, look = asked
    assert coupled_leaders(inquiry, look.rivals[:1]) == []
