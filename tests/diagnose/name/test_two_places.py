"""Where estimates at two places leave next to nothing together, the known causes of these are told."""

import pytest

from crashkit.diagnose.claims import identity, propose_all
from crashkit.diagnose.fitting.evidence import best_forms, is_unknown, ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import two_places
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.two_places import couples_at_two_places
from crashkit.model import Parameter
from crashkit.model.edit import with_factor
from crashkit.testing import toys

TORN = {"softening_deformation": 0.2, "softening_length": 0.1, "loss": 0.4}
FIRST, SECOND = ("fracture", "joint first"), ("fracture", "joint second")
ASKED = ("fracture", "carried_load", "unknown")
STAND_IN, PLACES = ("carried_load", "body rear"), {"joint first", "joint second"}


@pytest.fixture(scope="module")
def asked(workshop, inquiry, misfit, recorded):
    """Of a model whose two members both break, an inquiry, and what estimates of their forces and a stand-in explain alone."""
    two, true = toys.two_degrees(), toys.two_degrees()
    for joint in ("first", "second"):
        true = with_factor(true, joint, "softening", {name: Parameter(value, fixed=True) for name, value in TORN.items()})
    given = misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
    base = begin(workshop.identifier, given).advance(60)
    claims = [p for p in propose_all(workshop, base.fitted()) if _is_asked(p) and not p.refined]
    starts = [workshop.misfit(base.fitted(), p.model).with_values(p.starts[0]) for p in claims]
    fits = [(p, begin(workshop.identifier, start).advance(40)) for p, start in zip(claims, starts, strict=True)]
    look = Look.of(best_forms(ranked_by_evidence(fits, base.deviance)), base.fitted())
    return inquiry(base, given=given, hypotheses={name: workshop.hypotheses[name] for name in ASKED}), look


def _is_asked(proposal):
    physics, place = identity(proposal)
    return (physics, place) == STAND_IN or (physics == "unknown" and proposal.form == "deformation" and place in PLACES)


def test_the_causes_of_both_places_are_told(asked):
    inquiry, look = asked
    known = next(rival for rival in look.rivals if not is_unknown(rival))
    best = couples_at_two_places(inquiry, look, known.search)[0]
    assert {identity(best.first), identity(best.second)} == {FIRST, SECOND}
    assert best.search.normalised == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("share", ["COUPLED", "LESS"])
def test_nothing_is_told_where_the_estimates_leave_hardly_less_than_a_known_cause_or_one_of_them(asked, monkeypatch, share):
    inquiry, look = asked
    known = next(rival for rival in look.rivals if not is_unknown(rival))
    monkeypatch.setattr(two_places, share, 0.0)
    assert couples_at_two_places(inquiry, look, known.search) == []


def test_a_single_estimate_points_to_no_two_places(asked):
    inquiry, look = asked
    known = next(rival for rival in look.rivals if not is_unknown(rival))
    single = Look.of([look.leader, known], look.before)
    assert couples_at_two_places(inquiry, single, known.search) == []
