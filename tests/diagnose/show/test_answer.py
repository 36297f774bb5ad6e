"""What is told of a finding beside others."""

import pytest
from attrs import evolve

from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import Finding
from crashkit.diagnose.show.answer import _alternatives, _beside, _with_experiment


def test_a_rival_is_told_from_what_was_found_beside_the_other_findings_as_they_are(workshop, model, misfit, recorded, claim):
    """It was fitted while another one was in another form, which the test of the two need not tell apart."""
    base = begin(workshop.identifier, misfit(model, slow=recorded(model, 0.9, 1), fast=recorded(model, 1.2, 2)))
    early = claim(base.misfit, "rate_dependence", "power", rate_amplitude=0.2, rate_exponent=0.5)
    late = claim(base.misfit, "rate_dependence", "linear", rate_slope=0.1)
    rival = claim(early.search.misfit, "ground_friction", "constant")
    found = Discovery.of(base, late.search, (Look.of([late], base.misfit),))
    best, other = _beside(workshop, found, rival, [late])
    assert other.model.joint("first").factors == best.model.joint("first").factors == ("rate_linear",)
    assert other.deviance(other.residual(other.start())) == pytest.approx(base.deviance, abs=10.0)


def test_the_most_probable_rival_is_told_first_and_tested_against(workshop, model, misfit, recorded, claim):
    """A twin stands before the others, whatever its odds."""
    base = begin(workshop.identifier, misfit(model, slow=recorded(model, 0.9, 1), fast=recorded(model, 1.2, 2)))
    winner = claim(base.misfit, "rate_dependence", "linear", rate_slope=0.1)
    twin = claim(base.misfit, "viscous_damping", "linear")
    rival = claim(base.misfit, "ground_friction", "constant")
    look = evolve(Look.of([winner, twin, rival], base.misfit), probabilities=(0.9, 1e-6, 0.1))
    assert [one.physics for one in _alternatives(look, 0.5)] == ["ground_friction"]
    untested = Finding("rate_dependence", "linear", "", 0.9, {"joint": "first"}, (), (0.0, 0.1), "both", {})
    told = _with_experiment(workshop, Discovery.of(base, winner.search, (look,)), untested, look)
    assert "ground_friction" in told.experiment
