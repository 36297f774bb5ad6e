"""Where measured accelerations lead a claim, without simulating anything."""

import pytest
from attrs import evolve

from crashkit.diagnose.name import propose_all
from crashkit.diagnose.regress import regressed
from crashkit.model import Parameter

STOP = {"stiffness": 3e5, "stop_deformation": 0.4}
SPEEDS = {"slow": 0.9, "fast": 1.3}


def silent(doing, share):
    """Nobody listens."""


@pytest.fixture
def starts(workshop):
    """Claims of some physics from their first starts, at the values that the user gave."""

    def of(given, *physics):
        proposals = [p for p in propose_all(workshop.hypotheses, given) if p.physics in physics and not p.refined]
        own = given.values(given.start())
        return [(proposal, {**proposal.null, **own, **proposal.starts[0]}) for proposal in proposals]

    return of


@pytest.fixture
def rough(model, misfit, recorded):
    """A model without the stop that was hit, its own numbers a quarter off."""
    fixed = {name: Parameter(value, fixed=True) for name, value in STOP.items()}
    (first,) = model.joints
    stopped = evolve(first, law=f"{first.law} + linear_stop", parameters={**first.parameters, **fixed})
    true = evolve(model, joints=(stopped,))
    off = {path: p.value * (1.25 if i % 2 else 0.8) for i, (path, p) in enumerate(model.free_parameters().items())}
    return misfit(model.with_values(off), **{name: recorded(true, speed) for name, speed in SPEEDS.items()})


def test_a_stop_is_found_from_rough_numbers(workshop, rough, starts):
    claims = starts(rough, "bottoming", "peak_load", "viscous_damping")
    entrants = regressed(workshop.equipped([p.model for p, _ in claims]), rough, claims, silent)
    proposal, search = min(entrants, key=lambda entrant: entrant[1].state.cost)
    values = search.misfit.values(search.point)
    assert (proposal.physics, proposal.form) == ("bottoming", "line")
    assert search.normalised == pytest.approx(1.0, abs=0.05)
    # Two lines in one curve: which of them is the stop, no recording tells.
    lines = values["joint.first.stop_deformation"], values["joint.first.densification_deformation"]
    assert min(lines) == pytest.approx(STOP["stop_deformation"], rel=0.02)


def test_what_has_no_equation_of_its_own_is_left_out(workshop, rough, starts):
    """An instrument's error, and a law with a memory."""
    claims = starts(rough, "gain_error", "relaxation", "peak_load")
    entrants = regressed(workshop.equipped([p.model for p, _ in claims]), rough, claims, silent)
    assert {proposal.physics for proposal, _ in claims} == {"gain_error", "relaxation", "peak_load"}
    assert {(p.physics, p.form) for p, _ in entrants if p.physics != "peak_load"} <= {("relaxation", "fading")}
    assert "peak_load" in {proposal.physics for proposal, _ in entrants}


def test_a_load_that_no_instrument_sees_has_none_either(workshop, rough, starts):
    claims = starts(rough, "carried_load")
    assert claims
    assert regressed(workshop.equipped([p.model for p, _ in claims]), rough, claims, silent) == []
