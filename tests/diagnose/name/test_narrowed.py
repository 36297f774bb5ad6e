"""A short force of the time is told as one pulse, and a narrow one of the deformation as one bump."""

import pytest
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import ranked_by_evidence
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import narrowed
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.name.narrowed import as_bump, in_one_bump, with_pulses
from crashkit.diagnose.result import place_of
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.testing import toys

PULSE = {"pulse_force": 6e4, "pulse_time": 0.06, "rise_time": 0.003, "fall_time": 0.006}
"""N and s; the heights of a table are 12.5 ms apart."""
SECOND = "joint second"


@pytest.fixture(scope="module")
def asked(workshop, inquiry, misfit, recorded):
    """Of two masses with a charge between them, an inquiry, and what tables of the time in the joints leave."""
    two = toys.two_degrees()
    charge = {name: Parameter(value, fixed=True) for name, value in PULSE.items()}
    true = with_joint(two, Joint("charge", ("front", "rear"), "pulse", charge))
    given = misfit(two, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
    base = begin(workshop.identifier, given).advance(60)
    tables = [p for p in propose_all(workshop, base.fitted(), "unknown") if p.form == "time" and "joint" in p.location]
    starts = [workshop.misfit(base.fitted(), table.model) for table in tables]
    fits = [(p, begin(workshop.identifier, start).advance(20)) for p, start in zip(tables, starts, strict=True)]
    return inquiry(base, given=given), Look.of(ranked_by_evidence(fits, base.deviance), base.fitted())


def test_a_short_force_is_told_as_a_pulse_where_it_acts(asked):
    inquiry, look = asked
    assert look.leader.search.normalised > 1.3
    told = with_pulses(inquiry, look).leader
    assert (told.proposal.form, place_of(told.proposal.location)) == ("pulse", SECOND)
    assert told.search.normalised == pytest.approx(1.0, abs=0.03)
    values = {path.rsplit(".", 1)[-1]: told.search.values[path] for path in told.proposal.parameters}
    assert values == pytest.approx(PULSE, rel=0.1)


def test_none_is_asked_for_where_a_table_leaves_nothing_or_another_claim_leads(asked, monkeypatch):
    inquiry, look = asked
    other = evolve(look.leader, proposal=evolve(look.leader.proposal, form="rate", estimate_of="rate"))
    elsewhere = evolve(look, rivals=(other, *look.rivals))
    assert with_pulses(inquiry, elsewhere) is elsewhere
    monkeypatch.setattr(narrowed, "UNEXPLAINED", float("inf"))
    assert with_pulses(inquiry, look) is look


DENT = {"bump_force": -4e4, "bump_deformation": 0.6, "bump_width": 0.08}
"""N and m: the joint gives way for a while as it is crushed."""
FORMS = {("unknown", "deformation"), ("progressive_folding", "sine")}


@pytest.fixture(scope="module")
def dented(workshop, inquiry, misfit, recorded, model):
    """Of a mass with a dent in its joint, an inquiry, and what the table of the deformation leaves, and folds."""
    claims = propose_all(workshop, misfit(model, run=recorded(model)), "unknown")
    dent = next(claim for claim in claims if claim.form == "bump").model
    names = {path.rsplit(".", 1)[-1]: path for path in dent.parameters()}
    true = dent.with_parameters({names[name]: evolve(dent.parameters()[names[name]], value=x) for name, x in DENT.items()})
    given = misfit(model, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2)).with_prior(0.3)
    base = begin(workshop.identifier, given).advance(60)
    forms = [p for p in propose_all(workshop, base.fitted()) if (p.physics, p.form) in FORMS]
    starts = [workshop.misfit(base.fitted(), p.model).with_values({**p.null, **p.starts[0]}) for p in forms]
    fits = [(p, begin(workshop.identifier, start).advance(40)) for p, start in zip(forms, starts, strict=True)]
    return inquiry(base, given=given), Look.of(ranked_by_evidence(fits, base.deviance), base.fitted())


@pytest.fixture(scope="module")
def bumped(dented):
    """The same, led by a bump."""
    return as_bump(*dented)


def test_a_narrow_force_of_the_deformation_is_told_as_a_bump(bumped):
    assert [(rival.proposal.physics, rival.proposal.form) for rival in bumped.rivals] == [
        ("unknown", "bump"),
        ("progressive_folding", "sine"),
    ]
    values = {path.rsplit(".", 1)[-1]: bumped.leader.search.values[path] for path in bumped.leader.proposal.parameters}
    assert values == pytest.approx(DENT, rel=0.1)


def test_none_is_told_where_a_known_cause_explains_as_much_or_acts_elsewhere(dented, bumped):
    inquiry, look = dented
    table, folds = look.rivals
    as_good = evolve(folds, search=bumped.leader.search)
    elsewhere = evolve(folds, proposal=evolve(folds.proposal, location={"body": "wall"}))
    for rival in (as_good, elsewhere):
        assert as_bump(inquiry, evolve(look, rivals=(table, rival))) is None
    assert as_bump(inquiry, evolve(look, rivals=(folds, table))) is None


@pytest.mark.parametrize("put_aside", [False, True])
def test_a_known_cause_that_leaves_something_gives_way_to_a_bump_at_its_place(dented, put_aside):
    """Whether the table was weighed against it or put aside."""
    inquiry, look = dented
    table, folds = look.rivals
    told = Look.of([folds], look.before) if put_aside else Look.of([folds, table], look.before)
    told = evolve(told, estimates=(table,) if put_aside else ())
    found = in_one_bump(inquiry, Discovery.of(inquiry.base, folds.search, (told,)))
    assert [look.leader.proposal.form for look in found.findings] == ["bump"]
    assert found.search.normalised == pytest.approx(1.0, abs=0.03)
    assert found.findings[0].probabilities[0] == max(found.findings[0].probabilities)


def test_it_does_not_where_it_leaves_nothing_or_no_table_leaves_less(dented, bumped):
    inquiry, look = dented
    table, folds = look.rivals
    as_good = evolve(folds, search=bumped.leader.search)
    for rivals in ([folds], [as_good, table], [folds, evolve(table, search=folds.search)]):
        found = Discovery.of(inquiry.base, rivals[0].search, (Look.of(rivals, look.before),))
        assert in_one_bump(inquiry, found) is found
