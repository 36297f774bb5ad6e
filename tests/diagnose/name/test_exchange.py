"""A stand-in gives way to what it stood in for."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import rival_of
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import exchange
from crashkit.diagnose.name.exchange import exchanged, in_its_stead
from crashkit.diagnose.name.look import Look
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint

DASHPOT = {"damping": 300.0, "clearance": 0.0, "engagement": 1e-3}


@pytest.fixture
def base(workshop, model, misfit, recorded):
    """The best fit of a model without its dashpot."""
    fixed = {name: Parameter(value, fixed=True) for name, value in DASHPOT.items()}
    true = with_joint(model, Joint("dashpot", ("wall", "front"), "viscous", fixed))
    given = misfit(model, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.3, 2))
    return begin(workshop.identifier, given).advance(40)


@pytest.fixture
def look(workshop, base):
    """A look that one form of a physics has won, fitted beside some findings."""

    def at(before, physics, form):
        proposals = propose_all(workshop, before.fitted())
        proposal = next(p for p in proposals if (p.physics, p.form) == (physics, form))
        start = workshop.misfit(before.fitted(), proposal.model).with_values({proposal.parameters[0]: 100.0})
        found = begin(workshop.identifier, start).advance(60)
        return Look((rival_of(proposal, found, before.deviance),), (1.0,), 0.0, before.fitted())

    return at


def test_a_dashpot_takes_the_place_of_the_friction_that_imitated_it(inquiry, base, look):
    friction = look(base, "joint_friction", "sharp")
    imitation = friction.leader.search
    last = look(imitation, "viscous_damping", "linear")
    (kept,), search = exchanged(inquiry(base), [friction], imitation, last)
    assert [rival.proposal.physics for rival in kept.rivals] == ["viscous_damping", "joint_friction"]
    assert kept.probabilities[0] > 0.99
    assert search.deviance < imitation.deviance - 20.0
    assert search.misfit.values(search.point)["joint.first_viscous_damping.damping"] == pytest.approx(300.0, rel=0.1)


def test_what_explains_no_more_takes_no_place(inquiry, base, look):
    dashpot = look(base, "viscous_damping", "linear")
    search = dashpot.leader.search
    assert exchanged(inquiry(base), [dashpot], search, look(search, "joint_friction", "sharp")) is None


def test_nothing_is_exchanged_where_next_to_nothing_is_left(inquiry, base, look, monkeypatch):
    friction = look(base, "joint_friction", "sharp")
    imitation = friction.leader.search
    last = look(imitation, "viscous_damping", "linear")
    monkeypatch.setattr(exchange, "FLOOR", imitation.normalised + 0.01)
    assert exchanged(inquiry(base), [friction], imitation, last) is None


def test_what_explained_nearly_as_much_alone_takes_the_place_of_the_first_beside_the_second(inquiry, base, look):
    """Not what explained far less, and not beside an estimate."""
    friction, dashpot = look(base, "joint_friction", "sharp"), look(base, "viscous_damping", "linear")
    second = look(friction.leader.search, "ground_friction", "constant")
    search = second.leader.search
    first = evolve(friction, rivals=(friction.leader, dashpot.leader))
    (told, kept), better = in_its_stead(inquiry(base), [first, second], search)
    assert [rival.proposal.physics for rival in told.rivals] == ["viscous_damping", "joint_friction"]
    assert kept is second
    assert better.deviance < search.deviance - 20.0
    weak = evolve(dashpot.leader, drop=0.7 * friction.leader.drop)
    untouched = [evolve(first, rivals=(friction.leader, weak)), second]
    assert in_its_stead(inquiry(base), untouched, search) == (untouched, search)
    table = evolve(second.leader, proposal=evolve(second.leader.proposal, physics="unknown"))
    estimated = [first, second.led_by(table)]
    assert in_its_stead(inquiry(base), estimated, search) == (estimated, search)
