"""Two causes at once: which two claims leave least of the equations of motion, and how a couple is told as two findings."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.diagnose import name
from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting import couples as of_couples
from crashkit.diagnose.fitting import from_given as of_claims
from crashkit.diagnose.fitting.couples import Couple, coupled, each_once, with_other_forms
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.from_given import FromGiven
from crashkit.diagnose.fitting.promises import led
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.pairs import both
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_factor, with_joint

TEAR = {"softening_deformation": 0.2, "softening_length": 0.15, "loss": 0.5}
DASHPOT = {"damping": 6e3, "clearance": 0.0, "engagement": 1e-3}
SECRETS = {("fracture", "joint first"), ("viscous_damping", "joint first")}


def silent(doing, share):
    """Nobody listens."""


def fixed(values):
    return {name: Parameter(value, fixed=True) for name, value in values.items()}


@pytest.fixture(scope="module")
def given(model, misfit, recorded):
    """A model with its own numbers 15 % off, and recordings of one that tears and has a dashpot."""
    torn = with_factor(model, "first", "softening", fixed(TEAR))
    true = with_joint(torn, Joint("dashpot", model.joints[0].bodies, "viscous", fixed(DASHPOT)))
    rough = {path: p.value * (1.15 if i % 2 else 0.85) for i, (path, p) in enumerate(model.free_parameters().items())}
    return misfit(model.with_values(rough), slow=recorded(true, 0.9, 1), fast=recorded(true, 1.3, 2)).with_prior(0.3)


@pytest.fixture(scope="module")
def proposals(workshop, given):
    """Some claims."""
    physics = ("fracture", "bottoming", "viscous_damping", "peak_load", "joint_friction", "rate_dependence", "bias")
    return [p for p in propose_all(workshop, given) if p.physics in physics and not p.refined]


@pytest.fixture(scope="module")
def equipped(workshop, proposals):
    return workshop.equipped([p.model for p in proposals])


@pytest.fixture(scope="module")
def claims(equipped, given, proposals):
    """Those from these values."""
    return FromGiven(equipped, given, proposals, silent)


@pytest.fixture(scope="module")
def couples(claims):
    """All couples of these claims."""
    return claims.couples(np.inf)


def test_two_causes_are_found_together(couples):
    """Neither of them alone comes near: with both, nothing but noise is left."""
    best = couples[0]
    assert {identity(best.first), identity(best.second)} == SECRETS
    assert best.search.normalised == pytest.approx(1.0, abs=0.05)
    values = best.search.misfit.values(best.search.point)
    assert next(value for path, value in values.items() if path.endswith("damping")) == pytest.approx(6e3, rel=0.1)


def test_what_takes_long_is_asked_once(claims, couples, monkeypatch):
    """By a near look, and by a wide one that comes after it."""
    for asked in ("opened", "regressed", "led", "coupled"):
        monkeypatch.setattr(of_claims, asked, None)
    again = claims.couples(0.0)
    assert again[0] is couples[0]
    assert len(again) <= len(couples)


def test_no_couple_holds_one_claim_twice_and_none_comes_twice(couples):
    claims = [frozenset((identity(one.first), identity(one.second))) for one in couples]
    assert all(len(claim) == 2 for claim in claims)
    assert len(set(claims)) == len(claims) > 1


def test_each_of_two_findings_is_weighed_beside_the_other(workshop, inquiry, given, couples):
    base = begin(workshop.identifier, given).advance(40)
    look = Look((), (), 1.0, base.fitted(), couples=tuple(couples))
    looks = both(inquiry(base), look)
    assert looks is not None
    assert {one.winner.identity for one in looks} == SECRETS
    for one in looks:
        without = begin(workshop.identifier, one.before)
        assert one.winner.drop == pytest.approx(without.deviance - couples[0].search.deviance, rel=1e-6)
        # A rival is another claim that was coupled with the one that stays.
        assert all(rival.drop <= one.winner.drop for rival in one.rivals)


def test_what_a_claim_explains_is_no_more_than_there_was_to_explain(workshop, inquiry, given, couples, monkeypatch):
    """A fit of the other claim alone may be caught far away."""

    def astray(workshop, base, rivals, last):
        stuck = base.fitted().with_values({name: 0.2 * value for name, value in base.misfit.values(base.point).items()})
        return begin(workshop.identifier, stuck)

    monkeypatch.setattr(name.inquiry, "rebuild", astray)
    base = begin(workshop.identifier, given).advance(40)
    first, second = both(inquiry(base), Look((), (), 1.0, base.fitted(), couples=tuple(couples)))
    for one in (first, second):
        assert one.leader.drop == pytest.approx(base.deviance - couples[0].search.deviance)


def test_a_second_claim_that_does_not_convince_makes_no_two_findings(workshop, inquiry, couples):
    """Where a model explains all without it."""
    base = begin(workshop.identifier, couples[0].search.fitted())
    search, biases = base, []
    for instrument in ("film", "accelerometer"):
        claims = propose_all(workshop, search.fitted())
        biases.append(next(p for p in claims if p.physics == "bias" and p.location["instrument"] == instrument))
        search = begin(workshop.identifier, workshop.misfit(search.fitted(), biases[-1].model)).advance(10)
    look = Look((), (), 1.0, base.fitted(), couples=(Couple(*biases, search),))
    assert all(inquiry(base).fit_with([Rival(bias, search, 0.0, 0.0)], search) for bias in biases)
    assert both(inquiry(base), look) is None


def test_a_claim_that_cannot_be_placed_alone_makes_no_two_findings(workshop, inquiry, given, couples):
    base = begin(workshop.identifier, given)
    nowhere = evolve(couples[0].second, form="of another world")
    look = Look((), (), 1.0, given, couples=(Couple(couples[0].first, nowhere, couples[0].search),))
    assert both(inquiry(base), look) is None


def test_of_two_claims_in_two_forms_the_better_is_kept(couples):
    best, other = couples[0], evolve(couples[0], search=couples[1].search)
    swapped = evolve(other, first=best.second, second=best.first)
    assert each_once([swapped, best, other]) == [best]


def test_a_claim_in_a_form_that_is_off_is_found_in_the_right_one(equipped, given, proposals, claims, couples):
    """Of two claims the equations may favour one in a form beside which the recordings contradict them."""
    known = [(p, end) for p, end in zip(proposals, claims.ends, strict=True) if end is not None]
    equations = led(equipped, given, known)

    def in_other_forms(couple):
        return coupled(equipped, given, with_other_forms(couple, equations), silent)

    wrong = in_other_forms(couples[0])[-1]
    assert wrong.search.normalised > 1.1
    assert in_other_forms(wrong)[0].search.normalised == pytest.approx(1.0, abs=0.05)


def begun(search, left):
    """A couple that the equations have led where a search stands, leaving so much of them."""
    return of_couples._Begun(None, None, search.fitted(), left, 1.0)


def test_simulations_choose_among_those_that_the_equations_hardly_tell_apart(equipped, couples):
    best, other = couples[0].search, couples[-1].search
    right, wrong, hopeless = begun(best, 110.0), begun(other, 100.0), begun(best, 500.0)
    assert of_couples._ahead(equipped, [wrong, right, hopeless], 1) == [right]


def test_nothing_is_simulated_where_the_equations_tell_couples_apart(equipped, couples, monkeypatch):
    monkeypatch.setattr(of_couples, "advance_all", None)
    first, second = begun(couples[-1].search, 100.0), begun(couples[0].search, 200.0)
    assert of_couples._ahead(equipped, [first, second], 1) == [first]
