"""Two of the causes that lead alone beside each other, and two of all."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.evidence import best_forms, ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.leaders import coupled_leaders
from crashkit.diagnose.name.look import Look
from crashkit.testing import toys

MASS, GAP = ("added_mass", "body rear"), ("clearance", "joint second")
ASKED = ("added_mass", "clearance", "carried_load", "peak_load", "unknown")


@pytest.fixture(scope="module")
def asked(workshop, inquiry, misfit, recorded):
    """Of a model whose rear mass is a tenth too small and that lacks a gap, an inquiry, and what some claims alone explain."""
    rear = evolve(toys.two_degrees().body("rear").mass, fixed=True)
    two = toys.two_degrees().with_parameters({"body.rear.mass": rear})
    two = two.with_parameters({path: evolve(p, fixed=True) for path, p in two.parameters().items() if "joint" in path})
    heavy = two.with_parameters({"body.rear.mass": evolve(rear, value=1.1 * rear.value)})
    loose = next(p for p in propose_all(workshop, misfit(heavy, run=recorded(heavy))) if identity(p) == GAP)
    (path,) = loose.parameters
    true = loose.model.with_parameters({path: evolve(loose.model.parameters()[path], value=0.1)})
    given = misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
    base = begin(workshop.identifier, given).advance(60)
    claims = [p for p in propose_all(workshop, base.fitted()) if p.physics in ASKED and not p.refined]
    starts = [workshop.misfit(base.fitted(), p.model).with_values(p.starts[0]) for p in claims]
    fits = [(p, begin(workshop.identifier, start).advance(40)) for p, start in zip(claims, starts, strict=True)]
    return inquiry(base, given=given), Look.of(best_forms(ranked_by_evidence(fits, base.deviance)), base.fitted())


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


def test_of_all_causes_those_two_leave_least(asked):
    inquiry, look = asked
    best = inquiry.from_given.couples(look.leader.search.excess)[0]
    assert {identity(best.first), identity(best.second)} == {MASS, GAP}
    assert best.search.normalised == pytest.approx(1.0, abs=0.05)


def test_a_single_leader_has_nothing_beside_it(asked):
    inquiry, look = asked
    assert coupled_leaders(inquiry, look.rivals[:1]) == []
