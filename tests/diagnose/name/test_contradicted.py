"""Where a further run contradicts an answer, the one of its rivals that explains all runs is told."""

from types import SimpleNamespace

import pytest
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import Rival, rival_of
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name import contradicted as asking
from crashkit.diagnose.name.contradicted import asked_first, named_nevertheless
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.forms import in_best_forms
from crashkit.diagnose.name.look import Look
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Proposal


@pytest.fixture
def contradicted(workshop, inquiry, model, misfit, recorded):
    """A model without its dashpot, fitted to two runs, and what chosen claims made of the slow one alone."""
    numbers = {"damping": 800.0, "clearance": 0.0, "engagement": 1e-3}
    true = with_joint(model, Joint("dashpot", ("wall", "front"), "viscous", {n: Parameter(v) for n, v in numbers.items()}))
    slow, fast = recorded(true, 0.9, 1), recorded(true, 1.2, 2)
    alone, both = misfit(model, slow=slow), misfit(model, slow=slow, fast=fast)
    base = begin(workshop.identifier, alone).advance(40)

    def ask(*claims):
        asked = evolve(workshop, hypotheses={name: workshop.hypotheses[name] for name in claims})
        proposals = propose_all(asked, base.fitted())
        first = {proposal.physics: proposal for proposal in reversed(proposals)}
        fits = [begin(workshop.identifier, workshop.misfit(base.fitted(), first[name].model)).advance(20) for name in claims]
        rivals = [rival_of(first[name], fit, base.deviance) for name, fit in zip(claims, fits, strict=True)]
        best = begin(workshop.identifier, both).advance(40)
        looks = (Look(tuple(rivals), (1.0,) * len(rivals), 0.0, base.fitted()),) if rivals else ()
        return asked_first(inquiry(best), looks)

    return ask


def test_the_rival_that_explains_all_runs_is_told(contradicted):
    found = contradicted("clearance", "viscous_damping")
    assert [look.leader.proposal.physics for look in found.findings] == ["viscous_damping"]
    assert found.search.normalised == pytest.approx(1.0, abs=0.05)
    assert set(found.search.misfit.recordings) == {"slow", "fast"}


def test_where_none_does_everything_must_be_asked(contradicted):
    assert contradicted("clearance") is None


def test_without_rivals_too(contradicted):
    assert contradicted() is None


def test_beside_one_number_of_an_instrument_the_structure_is_asked_at_once(monkeypatch):
    clock = Proposal("clock_offset", "constant", {"instrument": "load cell"}, None, ("clock_offset",), {})
    misfit = SimpleNamespace(independent_samples=1000.0)
    fit = SimpleNamespace(deviance=1200.0, excess=0.2, misfit=misfit)
    monkeypatch.setattr(asking, "check_rate", lambda *_: None)
    monkeypatch.setattr(asking, "beside_reading", lambda inquiry, look: look.leader)
    inquiry = SimpleNamespace(base=SimpleNamespace(deviance=5000.0), fit_with=lambda claims, last: fit)
    told = asked_first(inquiry, (Look((Rival(clock, None, 100.0, 50.0),), (1.0,), 0.0, None),))
    assert (told.search, told.drop) == (fit, 3800.0)


@pytest.fixture
def refound(workshop, inquiry, model, misfit, recorded):
    """Two findings of a slow run, one in a form that is off, and what is said of them beside a faster run."""
    power = {"damping": 800.0, "exponent": 1.6, "tension": 0.0, "clearance": 0.0, "engagement": 1e-3}
    dashpot = Joint("dashpot", ("wall", "front"), "viscous_power", {n: Parameter(v, fixed=True) for n, v in power.items()})
    true = with_joint(model, dashpot)

    def too_little(dataset):
        return dataset.assign(acceleration=0.8 * dataset["acceleration"])

    slow, fast = (recorded(true, speed, seed, accelerometer=too_little) for speed, seed in ((0.9, 1), (1.2, 2)))

    def ask(*claims):
        alone, both = misfit(model, slow=slow), misfit(model, slow=slow, fast=fast)
        current = begin(workshop.identifier, alone).advance(40)
        looks = []
        for name, form in claims:
            forms = [p for p in propose_all(workshop, current.fitted()) if (p.physics, p.form) == (name, form)]
            claim = next(p for p in forms if p.location.get("instrument") != "film")
            search = begin(workshop.identifier, workshop.misfit(current.fitted(), claim.model)).advance(40)
            looks.append(Look((rival_of(claim, search, current.deviance),), (1.0,), 0.0, current.fitted()))
            current = search
        best = begin(workshop.identifier, both).advance(40)
        return asked_first(inquiry(best), looks)

    return ask


def test_two_findings_are_told_in_the_forms_that_all_runs_ask_for(refound, inquiry, workshop):
    found = refound(("gain_error", "constant"), ("viscous_damping", "linear"))
    gain, damping = (look.leader.proposal for look in found.findings)
    # It was put in its best form first, beside a damper in a poor one; once that is right, it is constant.
    findings, _ = in_best_forms(inquiry(begin(workshop.identifier, found.base)), found.findings, found.search, thorough=True)
    assert (gain.physics, findings[0].leader.proposal.form) == ("gain_error", "constant")
    assert damping.form.startswith("power")
    assert found.search.misfit.values(found.search.point)["joint.first_viscous_damping.exponent"] == pytest.approx(
        1.6, abs=0.1
    )
    assert all(set(look.before.recordings) == {"slow", "fast"} and look.leader.drop > 100.0 for look in found.findings)


def test_where_no_form_of_them_explains_all_runs_everything_must_be_asked(refound):
    assert refound(("gain_error", "constant"), ("clearance", "gap")) is None


@pytest.mark.parametrize("strained", [False, True])
def test_two_that_leave_too_little_of_all_runs_for_a_third_are_told(monkeypatch, strained):
    """Unless the model's own numbers had to be strained for it."""
    search = SimpleNamespace(misfit=SimpleNamespace(is_strained=lambda point: strained), point=None, fitted=lambda: None)
    monkeypatch.setattr(asking, "_with_all_runs", lambda inquiry, look, claims, fit: look)
    monkeypatch.setattr(asking, "in_best_forms", lambda inquiry, findings, fit: (findings, fit))
    monkeypatch.setattr(asking, "explains", lambda fit: False)
    monkeypatch.setattr(asking, "leave_no_third", lambda findings, fit, base: len(findings) == 2)
    looks = [Look((Rival(Proposal(one, "", {}, None, (), {}), search, 9e3, 4e3),), (1.0,), 0.0, None) for one in "ab"]
    told = asked_first(SimpleNamespace(base=search, fit_with=lambda claims, last: last), looks)
    assert told is None if strained else told.findings == tuple(looks)


@pytest.mark.parametrize(("stand", "left", "is_told"), [(True, 1.1, True), (True, 1.2, False), (False, 1.1, False)])
def test_two_that_stand_are_gone_on_with(monkeypatch, stand, left, is_told):
    """They were only seen more finely; unless that leaves much, nothing is asked from the beginning."""
    search = SimpleNamespace(misfit=SimpleNamespace(is_strained=lambda point: False), point=None, fitted=lambda: None)
    monkeypatch.setattr(asking, "_with_all_runs", lambda inquiry, look, claims, fit: look)
    monkeypatch.setattr(asking, "in_best_forms", lambda inquiry, findings, fit: (findings, fit))
    monkeypatch.setattr(asking, "explains", lambda fit: False)
    monkeypatch.setattr(asking, "leave_no_third", lambda findings, fit, base: False)
    monkeypatch.setattr(asking, "look_again", lambda inquiry, current, found: [one.proposal.physics for one in found])
    further = SimpleNamespace(search=SimpleNamespace(normalised=left))
    monkeypatch.setattr(asking, "followed", lambda inquiry, begun, look: (further, look) if look == ["a", "b"] else None)
    looks = [Look((Rival(Proposal(one, "", {}, None, (), {}), search, 9e3, 4e3),), (1.0,), 0.0, None) for one in "ab"]
    told = asked_first(SimpleNamespace(base=search, fit_with=lambda claims, last: last), looks, stand)
    assert told is (further if is_told else None)


@pytest.mark.parametrize(
    ("joint", "left", "told"),
    [("first", 1.2, "progressive_folding"), ("first", 1.5, "unknown"), ("second", 1.2, "unknown")],
)
def test_a_name_that_all_runs_but_one_gave_stays_before_an_estimate_at_its_place(monkeypatch, inquiry, joint, left, told):
    """If it leaves little of all runs."""

    def claimed(physics, normalised):
        search = SimpleNamespace(normalised=normalised, fitted=lambda: None)
        place = {"joint": joint if physics == "unknown" else "first"}
        return Rival(Proposal(physics, "", place, None, (), {}), search, 9000.0, 4500.0)

    estimate, named = claimed("unknown", 1.0), claimed("progressive_folding", left)
    monkeypatch.setattr(asking, "_ranked", lambda inquiry, rivals: [named])
    looks = [Look((claimed("progressive_folding", 1.0),), (1.0,), 0.0, None)]
    found = Discovery(None, None, estimate.search, (Look((estimate,), (1.0,), 0.0, None),))
    base = SimpleNamespace(misfit=None, fitted=lambda: None)
    assert named_nevertheless(inquiry(base, given=True), looks, found).findings[0].leader.proposal.physics == told
