"""A look settled: its winner re-identified, and challenged by what says it in fewer numbers or acts at its place."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.candidates import Candidate
from crashkit.diagnose.fitting.evidence import Rival, ranked_by_evidence, rival_of
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import challenge, settle
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.settle import in_one_number, settled
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_factor, with_joint
from crashkit.testing import toys

FRICTION = "joint_friction"
LONGEST = 1.6
"""m, about what the first joint of two is deformed by at most."""


def test_a_winner_that_leaves_something_is_identified_again(workshop, inquiry, offered):
    """It had stopped where its dashpot was ten times too strong."""
    look, _, final = offered(800.0)
    damping = look.leader.proposal.parameters[0]
    misled = final.misfit.with_values({**final.misfit.values(final.point), damping: 8000.0})
    winner = evolve(look.leader, search=begin(workshop.identifier, misled), evidence=0.5 * look.leader.drop)
    found = settled(inquiry(begin(workshop.identifier, look.before)), look, winner, []).leader
    gained = winner.search.deviance - found.search.deviance
    assert found.search.deviance == pytest.approx(final.deviance, abs=1.0)
    assert (found.drop - winner.drop, found.evidence - winner.evidence) == pytest.approx((gained, 0.5 * gained))


def test_a_winner_that_explains_everything_is_left_as_it_is(workshop, inquiry, offered):
    look, _, _ = offered(800.0)
    winner = evolve(look.leader, evidence=0.5 * look.leader.drop)
    told = settled(inquiry(begin(workshop.identifier, look.before)), evolve(look, rivals=(winner,)), winner, [])
    assert told.leader is winner


def test_a_first_winner_that_was_settled_and_asked_in_all_forms_is_not_again(inquiry, offered, monkeypatch):
    look, base, _ = offered(800.0)
    monkeypatch.setattr(settle, "reidentified", lambda *_: pytest.fail("it was settled"))
    asked = evolve(look, formed=look.leader.search)
    assert settled(inquiry(base), asked, asked.leader, []) is asked
    with pytest.raises(pytest.fail.Exception, match="it was settled"):
        settled(inquiry(base), asked, asked.leader, [evolve(look.leader)])


def test_whatever_may_act_at_the_place_of_a_winner_challenges_it(workshop, inquiry, offered):
    """Friction that was given up early, told from where a damper in its place has driven the model's own numbers."""
    look, _, final = offered(800.0)
    damper = look.leader
    friction = next(p for p in propose_all(workshop, look.before) if (p.physics, p.form) == (FRICTION, "sharp"))
    stand_in = begin(workshop.identifier, workshop.misfit(look.before, friction.model).with_values(friction.starts[0]))
    winner = Rival(friction, stand_in.advance(60), look.before.deviance(look.before.residual(look.before.start())), 0.0)
    winner = evolve(winner, drop=winner.drop - winner.search.deviance)
    told = settled(inquiry(begin(workshop.identifier, look.before)), evolve(look, rivals=(winner,)), winner, [])
    assert told.leader.identity == damper.identity
    assert told.leader.search.deviance == pytest.approx(final.deviance, abs=1.0)


@pytest.mark.parametrize(("late", "way"), [(0.5, "_promising"), (0.75, "_promising"), (0.6, "_alike")])
def test_a_challenger_begins_where_it_promises_most_or_acts_most_alike(
    workshop, inquiry, misfit, recorded, monkeypatch, late, way
):
    """A joint that breaks late is not found from the first place where a loss may begin, nor always from the best of them."""
    other = {"_promising": "_alike", "_alike": "_promising"}[way]
    monkeypatch.setattr(challenge, other, lambda *_: [])
    two = toys.two_degrees()
    loss = _claimed(workshop, misfit(two, run=recorded(two)), ("fracture", "compression"))
    values = {"loss": 0.3, "softening_deformation": late * LONGEST, "softening_length": 0.1 * LONGEST}
    wanted = {path: values[path.rsplit(".", 1)[1]] for path in loss.parameters}
    true = loss.model.with_parameters({path: evolve(loss.model.parameters()[path], value=v) for path, v in wanted.items()})
    base = begin(workshop.identifier, misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2))).advance(40)
    stop = _claimed(workshop, base.fitted(), ("bottoming", "line"))
    fit = begin(workshop.identifier, workshop.misfit(base.fitted(), stop.model).with_values(stop.starts[0])).advance(40)
    (winner,) = ranked_by_evidence([(stop, fit)], base.deviance)
    few = {name: workshop.hypotheses[name] for name in ("bottoming", "fracture")}
    look = Look((winner,), (1.0,), 0.0, base.fitted())
    told = settled(inquiry(base, given=base.fitted(), hypotheses=few), look, winner, [])
    assert told.leader.identity == ("fracture", "joint first")
    assert told.leader.search.values[loss.parameters[0]] == pytest.approx(0.3, rel=0.05)


def _claimed(workshop, at, claim):
    """What is claimed of the first joint."""
    proposed = propose_all(workshop, at, claim[0])
    return next(p for p in proposed if p.form == claim[1] and p.location == {"joint": "first"})


@pytest.mark.parametrize("entered", [True, False])
def test_a_load_on_a_stiff_tie_gives_way_to_a_mass_that_is_wrong(workshop, inquiry, misfit, recorded, entered):
    """The mass was only fitted from where the model without it had been driven, and had not got far, or was given up."""
    rear = evolve(toys.two_degrees().body("rear").mass, fixed=True)
    two = toys.two_degrees().with_parameters({"body.rear.mass": rear})
    true = two.with_parameters({"body.rear.mass": evolve(rear, value=1.2 * rear.value)})
    given = misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.03)
    base = begin(workshop.identifier, given).advance(40)
    everything = [p for p in propose_all(workshop, base.fitted()) if p.location == {"body": "rear"}]
    mass = next(p for p in everything if p.physics == "added_mass")
    load = next(p for p in everything if p.form == "tied")
    begun = [
        begin(workshop.identifier, workshop.misfit(base.fitted(), p.model).with_values(p.starts[0])) for p in (load, mass)
    ]
    rivals = ranked_by_evidence([(load, begun[0].advance(60)), (mass, begun[1])], base.deviance)[: 2 if entered else 1]
    assert rivals[0].proposal is load
    look = settled(inquiry(base, given=base.fitted()), Look(tuple(rivals), (1.0, 0.0), 0.0, base.fitted()), rivals[0], [])
    assert look.winner.identity == ("added_mass", "body rear")
    found = look.winner.search
    assert found.misfit.values(found.point)["body.rear.mass"] == pytest.approx(1.2 * rear.value, rel=0.02)


DASHPOT = {"damping": 5e3, "clearance": 0.0, "engagement": 1e-3}
TEAR = {"softening_deformation": 0.2, "softening_length": 0.15, "loss": 0.5}


def fixed(values):
    return {name: Parameter(value, fixed=True) for name, value in values.items()}


def test_a_mass_that_challenges_a_load_begins_with_it_and_without(workshop, inquiry, misfit, recorded, monkeypatch):
    """From what the model says, with all else where the load had driven it, it may stay in a valley."""
    rear = evolve(toys.two_degrees().body("rear").mass, fixed=True)
    two = toys.two_degrees().with_parameters({"body.rear.mass": rear})
    given = misfit(two, slow=recorded(two, 0.9, 1))
    claims = {p.physics: p for p in propose_all(workshop, given) if p.location == {"body": "rear"} and not p.refined}
    load, mass = claims["carried_load"], claims["added_mass"]
    loaded = workshop.misfit(given, load.model).with_values({load.parameters[0]: 50.0})
    winner = Rival(load, begin(workshop.identifier, loaded), 1e9, 1e9)
    begun = []
    monkeypatch.setattr(challenge, "begin_candidates", lambda identifier, claims, misfits: begun.extend(misfits) or [])
    monkeypatch.setattr(challenge, "heats", lambda *_: [])
    challenge.challenged(inquiry(winner.search), Look((winner,), (1.0,), 0.0, given), [mass])
    assert [one.model.values()["body.rear.mass"] for one in begun] == pytest.approx([rear.value + 50.0, rear.value])


@pytest.fixture
def both_told(workshop, inquiry, misfit, recorded):
    """A claim and a dashpot, fitted together to recordings of a secret with one, in the light of claims of one number."""

    def told(model, secret, asked):
        secret = with_joint(secret, Joint("dashpot", secret.joints[0].bodies, "viscous", fixed(DASHPOT)))
        given = misfit(model, slow=recorded(secret, 0.9, 1), fast=recorded(secret, 1.2, 2)).with_prior(0.1)
        base = begin(workshop.identifier, given).advance(40)
        searches, claims = [base], []
        for physics, form, location in (asked, ("viscous_damping", "linear", {"joint": "first"})):
            everything = propose_all(workshop, searches[-1].fitted(), physics)
            claims.append(next(p for p in everything if p.form == form and p.location == location))
            equipped = workshop.equipped([claims[-1].model]).misfit(searches[-1].fitted(), claims[-1].model)
            begun = [begin(workshop.identifier, equipped.with_values(start)) for start in claims[-1].starts]
            searches.append(min((one.advance(60) for one in begun), key=lambda one: one.deviance))
        rivals = [rival_of(one, searches[-1], base.deviance) for one in claims]
        looks = [Look((rival,), (1.0,), 0.0, base.fitted()) for rival in rivals]
        return in_one_number(inquiry(base, given=base.fitted()), looks, searches[-1]), looks, searches[-1]

    return told


def test_of_two_findings_a_load_on_a_stiff_tie_gives_way_to_a_mass(both_told):
    rear = evolve(toys.two_degrees().body("rear").mass, fixed=True)
    two = toys.two_degrees().with_parameters({"body.rear.mass": rear})
    heavy = two.with_parameters({"body.rear.mass": evolve(rear, value=1.2 * rear.value)})
    (findings, search), _, before = both_told(two, heavy, ("carried_load", "tied", {"body": "rear"}))
    assert [look.leader.identity for look in findings] == [("added_mass", "body rear"), ("viscous_damping", "joint first")]
    assert search is findings[0].leader.search
    assert search.normalised == pytest.approx(1.0, abs=0.05)
    assert search.deviance < before.deviance + 10.0


def test_of_two_findings_one_that_needs_its_numbers_keeps_them(both_told, model):
    torn = with_factor(model, "first", "softening", fixed(TEAR))
    (findings, search), looks, before = both_told(model, torn, ("fracture", "compression", {"joint": "first"}))
    assert before.normalised < 2.0
    assert (findings, search) == (looks, before)


@pytest.mark.parametrize(
    ("left", "strained", "also_left", "share", "little", "is_asked"),
    [
        (1.0, False, 1.0, 1.0, 0.0, True),
        (1.0, False, 1.2, 1.0, 0.0, False),
        (1.0, True, 1.2, 0.95, 0.0, True),
        (1.0, True, 1.2, 0.8, 0.0, False),
        (1.2, False, 2.0, 0.95, 0.0, True),
        (1.2, False, 2.0, 0.8, 0.0, False),
        (2.0, False, 2.0, 1.0, 0.0, False),
        (2.0, False, 2.0, 1.0, 1.0, True),
    ],
)
def test_what_leaves_hardly_more_at_its_place_is_asked_in_all_its_forms(
    inquiry, workshop, offered, monkeypatch, left, strained, also_left, share, little, is_asked
):
    """Friction told first, and a damper that explains nearly as much: only its best form is what is there. What strains the
    model's own numbers at the noise is compared with it as well, and what leaves little of what there was."""
    monkeypatch.setattr(settle, "LITTLE", little)
    look, base, final = offered(800.0)
    damper = look.leader.proposal
    friction = next(p for p in propose_all(workshop, look.before) if (p.physics, p.location) == (FRICTION, damper.location))
    misfit = SimpleNamespace(is_strained=lambda point: strained)
    led = SimpleNamespace(normalised=left, deviance=final.deviance, misfit=misfit, point=None)
    winner = Rival(friction, led, look.leader.drop, 0.0)
    plain = Rival(damper, SimpleNamespace(normalised=also_left), share * look.leader.drop, -25.0)
    asked = []

    def in_all_forms(inquiry, rival, others, search):
        asked.append(rival.proposal.physics)
        return [Candidate(rival.proposal, final)] if rival is plain else []

    monkeypatch.setattr(settle, "in_all_forms", in_all_forms)
    monkeypatch.setattr(settle, "reidentified", lambda inquiry, look, winner: look)
    monkeypatch.setattr(settle, "challengers", lambda inquiry, look, found: [])
    told = settled(inquiry(base), evolve(look, rivals=(winner, plain)), winner, [])
    assert asked == ([FRICTION, "viscous_damping"] if is_asked else [])
    assert told.leader.proposal.physics == ("viscous_damping" if is_asked else FRICTION)
