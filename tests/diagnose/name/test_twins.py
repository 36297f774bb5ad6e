"""What no recording tells apart shares its odds, in whatever form it was found."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import rival_of
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.twins import beside_twins
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint

FRICTION = {"friction_force": 6e3, "slip_rate": 0.05, "stick": 0.8, "stick_rate": 0.6}
TWINS = {("joint_friction", "joint first"), ("ground_friction", "body front")}


@pytest.fixture(scope="module")
def rubbing(workshop, model, misfit, recorded):
    """A mass that friction brakes in its joint to the wall: the fit without it, and one with it in a form that falls."""
    fixed = {name: Parameter(value, fixed=True) for name, value in FRICTION.items()}
    true = with_joint(model, Joint("rub", ("wall", "front"), "coulomb", fixed))
    base = begin(workshop.identifier, misfit(model, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2))).advance(40)
    proposals = propose_all(workshop, base.fitted())
    falling = next(p for p in proposals if (p.physics, p.form) == ("joint_friction", "falling"))
    start = workshop.misfit(base.fitted(), falling.model).with_values(falling.starts[0])
    return base, falling, begin(workshop.identifier, start).advance(60)


@pytest.fixture(scope="module")
def beside(workshop, rubbing):
    """What is told of that friction with its twins, where its form has these odds."""

    def beside(odds):
        base, falling, search = rubbing
        look = Look((rival_of(evolve(falling, odds=odds), search, base.deviance),), (1.0,), 0.0, base.fitted())
        return beside_twins(workshop, Discovery(base.fitted(), search.fitted(), search, (look,)))

    return beside


def test_friction_in_the_joint_to_the_wall_may_be_friction_on_the_ground(beside):
    """Both forces are the same; the form that falls with the rate was only ever fitted in the joint."""
    (told,) = beside(1.0).findings
    assert {rival.identity for rival in told.rivals[:2]} == TWINS
    assert abs(told.probabilities[0] - told.probabilities[1]) < 0.2
    assert sum(told.probabilities[:2]) > 0.95


def test_the_likeliest_of_them_is_told(beside, rubbing):
    discovery = beside(0.2)
    (told,) = discovery.findings
    assert [rival.proposal.physics for rival in told.rivals[:2]] == ["ground_friction", "joint_friction"]
    assert told.probabilities[0] == pytest.approx(5.0 * told.probabilities[1], rel=0.5)
    assert set(told.leader.proposal.parameters) <= set(discovery.final.names)
    assert discovery.search.deviance == pytest.approx(rubbing[2].deviance, rel=1e-3)


def test_what_was_weighed_without_the_other_findings_takes_no_odds_from_a_twin(workshop, rubbing, claim):
    """A rival may have explained more before another finding was made."""
    base, falling, search = rubbing
    found = rival_of(falling, search, base.deviance)
    known = {"ground_friction": "constant", "viscous_damping": "linear"}
    early = [claim(base.misfit, physics, form) for physics, form in known.items()]
    stale = [evolve(one, evidence=10.0 * found.evidence) for one in early]
    look = Look((found, *stale), (0.9, 0.06, 0.04), 0.0, base.fitted())
    (told,) = beside_twins(workshop, Discovery(base.fitted(), search.fitted(), search, (look,))).findings
    chances = {rival.identity: chance for rival, chance in zip(told.rivals, told.probabilities, strict=True)}
    assert sum(chances[twin] for twin in TWINS) == pytest.approx(0.96)
    assert chances[stale[1].identity] == 0.04
    assert told.probabilities[0] == max(told.probabilities)


@pytest.fixture
def estimated(workshop, model, misfit, recorded):
    """What is told of an estimated force in a joint, with its twins."""

    def estimated(form):
        base = begin(workshop.identifier, misfit(model, run=recorded(model)))
        table = next(p for p in propose_all(workshop, base.fitted()) if p.physics == "unknown" and p.form == form)
        search = begin(workshop.identifier, workshop.misfit(base.fitted(), table.model)).advance(40)
        beside_known_laws = evolve(rival_of(table, search, base.deviance), evidence=-1e3)
        look = Look((beside_known_laws,), (1.0,), 0.0, base.fitted())
        discovery = Discovery(base.fitted(), search.fitted(), search, (look,))
        return look, beside_twins(workshop, discovery).findings[0]

    return estimated


def test_an_estimated_force_of_the_motion_has_no_twins(estimated):
    found, told = estimated("deformation")
    assert told is found


def test_an_estimated_force_of_the_time_is_rather_one_on_the_body_than_in_its_joint_to_the_wall(estimated):
    _, told = estimated("time")
    assert [rival.place for rival in told.rivals[:2]] == ["body front", "joint first"]
    assert told.probabilities[0] == pytest.approx(2.0 * told.probabilities[1], rel=0.2)


def test_what_another_finding_added_is_no_place_for_a_twin(workshop, rubbing):
    """A member that breaks, and rubs: its friction, which is a joint of the fitted model, does not break."""
    base, falling, rubs = rubbing
    breaks = next(p for p in propose_all(workshop, rubs.fitted()) if (p.physics, p.form) == ("fracture", "compression"))
    both = begin(workshop.identifier, workshop.misfit(rubs.fitted(), breaks.model).with_values(breaks.starts[0])).advance(5)
    claims = [rival_of(falling, both, base.deviance), rival_of(breaks, both, rubs.deviance)]
    looks = tuple(Look((claim,), (1.0,), 0.0, base.fitted()) for claim in claims)
    told = beside_twins(workshop, Discovery(base.fitted(), both.fitted(), both, looks))
    places = {rival.proposal.location.get("joint") for look in told.findings for rival in look.rivals}
    assert places <= {"first", None}
