"""Two causes of one number each instead of one of many."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.candidates import Candidate, weigh_candidates
from crashkit.diagnose.fitting.evidence import ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.simpler import in_fewer_numbers
from crashkit.testing import toys

BODIES = ["front", "rear"]
FILTERED = {"channel_frequency_class": 180}
MASS, GAP = ("added_mass", "body rear"), ("clearance", "joint second")
CLAIMS = [("carried_load", "belt"), ("added_mass", "constant"), ("clearance", "gap")]


@pytest.fixture
def two():
    """Two bodies of which the rear one's mass and the joints are known."""
    two = toys.two_degrees().with_parameters({"body.rear.mass": evolve(toys.two_degrees().body("rear").mass, fixed=True)})
    return two.with_parameters({path: evolve(p, fixed=True) for path, p in two.parameters().items() if "joint" in path})


@pytest.fixture
def asked(workshop, inquiry, misfit, recorded, two):
    """What is told instead of a load in a belt, of recordings of a model."""

    def ask(true, **changes):
        runs = {"slow": recorded(true, 0.9, 1, **changes), "fast": recorded(true, 1.2, 2, **changes)}
        base = begin(workshop.identifier, misfit(two, **runs))
        everything = propose_all(workshop, base.fitted())
        claims = [p for p in everything if (p.physics, p.form) in CLAIMS and "front" not in p.location.values()]
        fits = [(p, begin(workshop.identifier, workshop.misfit(base.fitted(), p.model)).advance(60)) for p in claims]
        rivals = ranked_by_evidence(weigh_candidates([Candidate(*fit) for fit in fits]), base.deviance)
        load = next(rival for rival in rivals if rival.proposal.physics == "carried_load")
        ranked = (load, *(rival for rival in rivals if rival is not load))
        found = Discovery(base.fitted(), load.search.fitted(), load.search, (Look(ranked, (1.0,), 0.0, base.fitted()),))
        return found, in_fewer_numbers(inquiry(base, given=base.fitted()), found)

    return ask


@pytest.fixture
def heavy_and_loose(workshop, misfit, recorded, two):
    """The model with a mass that is wrong by a tenth, and a gap in a joint."""

    def build(gap):
        mass = two.body("rear").mass
        heavy = two.with_parameters({"body.rear.mass": evolve(mass, value=1.1 * mass.value)})
        loose = next(p for p in propose_all(workshop, misfit(heavy, run=recorded(heavy))) if identity(p) == GAP)
        (path,) = loose.parameters
        return loose.model.with_parameters({path: evolve(loose.model.parameters()[path], value=gap)})

    return build


def test_a_load_in_a_belt_gives_way_to_a_mass_and_a_gap(asked, heavy_and_loose):
    found, told = asked(heavy_and_loose(0.1))
    assert {look.leader.identity for look in told.findings} == {MASS, GAP}
    assert told.search.deviance < found.search.deviance


def test_a_gap_that_nothing_asks_for_is_not_told_beside_a_mass(asked, heavy_and_loose):
    found, told = asked(heavy_and_loose(0.0))
    assert told is found


def test_where_the_noise_is_open_what_is_left_does_not_pass_for_noise(asked, workshop, misfit, recorded, two):
    """Weighed by what each of them leaves, all claims leave 1."""
    belts = propose_all(workshop, misfit(two, run=recorded(two)), "carried_load")
    belt = next(p for p in belts if p.form == "belt" and p.location["body"] == "rear")
    true = belt.model.with_parameters(
        {path: evolve(belt.model.parameters()[path], value=v) for path, v in belt.starts[-1].items()}
    )
    found, told = asked(
        true,
        film=lambda film: film.isel(marker=film["marker_body"].isin(BODIES)).drop_vars("position_std").assign_attrs(FILTERED),
        accelerometer=lambda felt: (
            felt.isel(sensor=felt["sensor_body"].isin(BODIES)).drop_vars("acceleration_std").assign_attrs(FILTERED)
        ),
    )
    assert told is found


def test_a_law_of_few_numbers_is_not_questioned(asked, heavy_and_loose, inquiry):
    found, _ = asked(heavy_and_loose(0.1))
    look = found.findings[0]
    mass = next(rival for rival in look.rivals if rival.identity == MASS)
    simple = evolve(found, findings=(evolve(look, rivals=(mass, *look.rivals[:1])),))
    assert in_fewer_numbers(inquiry(None), simple) is simple
