"""What no recording tells apart shares its odds, in whatever form it was found."""

from crashkit.diagnose.evidence import rival_of
from crashkit.diagnose.look import Round
from crashkit.diagnose.name import propose_all
from crashkit.diagnose.rounds import Discovery
from crashkit.diagnose.search import begin
from crashkit.diagnose.twins import beside_twins
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint

FRICTION = {"friction_force": 6e3, "slip_rate": 0.05, "stick": 0.8, "stick_rate": 0.6}


def test_friction_in_the_joint_to_the_wall_may_be_friction_on_the_ground(workshop, model, misfit, recorded):
    """Both forces are the same; the form that falls with the rate was only ever fitted in the joint."""
    fixed = {name: Parameter(value, fixed=True) for name, value in FRICTION.items()}
    true = with_joint(model, Joint("rub", ("wall", "front"), "coulomb", fixed))
    base = begin(workshop.identifier, misfit(model, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2))).advance(40)
    proposals = propose_all(workshop.hypotheses, base.fitted())
    falling = next(p for p in proposals if (p.physics, p.form) == ("joint_friction", "falling"))
    search = begin(workshop.identifier, workshop.misfit(base.fitted(), falling.model).with_values(falling.starts[0])).advance(
        60
    )
    look = Round((rival_of(falling, search, base.deviance),), (1.0,), 0.0, base.fitted())
    (told,) = beside_twins(workshop, Discovery(base.fitted(), search.fitted(), search, (look,))).rounds
    assert [rival.identity for rival in told.rivals[:2]] == [
        ("joint_friction", "joint first"),
        ("ground_friction", "body front"),
    ]
    assert told.rivals[0] is look.rivals[0]
    assert abs(told.probabilities[0] - told.probabilities[1]) < 0.2
    assert sum(told.probabilities[:2]) > 0.95


def test_an_estimated_force_has_no_twins(workshop, model, misfit, recorded):
    base = begin(workshop.identifier, misfit(model, run=recorded(model)))
    table = next(p for p in propose_all(workshop.hypotheses, base.fitted()) if p.physics == "unknown")
    search = begin(workshop.identifier, workshop.misfit(base.fitted(), table.model))
    look = Round((rival_of(table, search, base.deviance),), (1.0,), 0.0, base.fitted())
    discovery = Discovery(base.fitted(), search.fitted(), search, (look,))
    assert beside_twins(workshop, discovery).rounds == discovery.rounds
