"""Two causes of one number each instead of one of many."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.evidence import ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.simpler import in_fewer_numbers
from crashkit.testing import toys

MASS, GAP = ("added_mass", "body rear"), ("clearance", "joint second")
CLAIMS = [("carried_load", "belt"), ("added_mass", "constant"), ("clearance", "gap")]


@pytest.fixture
def asked(workshop, inquiry, misfit, recorded):
    """What is told instead of a load in a belt, where a mass is wrong by a share, and a joint has a gap."""

    def ask(share, gap):
        rear = evolve(toys.two_degrees().body("rear").mass, fixed=True)
        two = toys.two_degrees().with_parameters({"body.rear.mass": rear})
        two = two.with_parameters({path: evolve(p, fixed=True) for path, p in two.parameters().items() if "joint" in path})
        heavy = two.with_parameters({"body.rear.mass": evolve(rear, value=share * rear.value)})
        loose = next(p for p in propose_all(workshop, misfit(heavy, run=recorded(heavy))) if identity(p) == GAP)
        (path,) = loose.parameters
        true = loose.model.with_parameters({path: evolve(loose.model.parameters()[path], value=gap)})
        base = begin(workshop.identifier, misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)))
        everything = propose_all(workshop, base.fitted())
        claims = [p for p in everything if (p.physics, p.form) in CLAIMS and "front" not in p.location.values()]
        fits = [(p, begin(workshop.identifier, workshop.misfit(base.fitted(), p.model)).advance(60)) for p in claims]
        rivals = ranked_by_evidence(fits, base.deviance)
        load = next(rival for rival in rivals if rival.proposal.physics == "carried_load")
        ranked = (load, *(rival for rival in rivals if rival is not load))
        found = Discovery(base.fitted(), load.search.fitted(), load.search, (Look(ranked, (1.0,), 0.0, base.fitted()),))
        return found, in_fewer_numbers(inquiry(base, given=base.fitted()), found)

    return ask


def test_a_load_in_a_belt_gives_way_to_a_mass_and_a_gap(asked):
    found, told = asked(1.1, 0.1)
    assert {look.leader.identity for look in told.findings} == {MASS, GAP}
    assert told.search.deviance < found.search.deviance


def test_a_gap_that_nothing_asks_for_is_not_told_beside_a_mass(asked):
    found, told = asked(1.1, 0.0)
    assert told is found


def test_a_law_of_few_numbers_is_not_questioned(asked, inquiry):
    found, _ = asked(1.1, 0.1)
    look = found.findings[0]
    mass = next(rival for rival in look.rivals if rival.identity == MASS)
    simple = evolve(found, findings=(evolve(look, rivals=(mass, *look.rivals[:1])),))
    assert in_fewer_numbers(inquiry(None), simple) is simple
