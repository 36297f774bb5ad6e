"""Shown the recordings little by little, a search comes through a motion in which it goes astray when it sees all at once."""

import numpy as np
import pytest

from crashkit.diagnose.fitting import continuation
from crashkit.diagnose.fitting.continuation import LEAST, LONGER, grown
from crashkit.diagnose.fitting.search import begin
from crashkit.errors import SimulationError
from crashkit.mechanics import Simulator
from crashkit.misfit import Misfit
from crashkit.model import Model, Parameter
from crashkit.testing import toys

LIGHT = {
    "body.front.mass": Parameter(50.0, fixed=True),
    "joint.first.unloading_stiffness": Parameter(1e6),
    "joint.second.unloading_stiffness": Parameter(4e6),
}


@pytest.fixture(scope="module")
def rattling() -> Model:
    """A light mass between two springs, of which one pushes it on as the other lets go."""
    return toys.two_degrees().with_parameters(LIGHT)


@pytest.fixture(scope="module")
def off(rattling, workshop):
    """The misfit of that model with its numbers up to 15 % wrong."""
    simulator = Simulator(rattling, workshop.laws, workshop.engine)
    motion = simulator.run(np.arange(1201) * 2.5e-4, initial=toys.initial_state(rattling, 1.0))
    recordings = {"run": toys.recording(motion)}

    def wrong(seed) -> Misfit:
        random = np.random.default_rng(seed)
        values = {path: p.value * random.uniform(0.85, 1.15) for path, p in rattling.free_parameters().items()}
        misfit = Misfit(rattling.with_values(values), recordings, workshop.laws, workshop.observers, workshop.engine)
        return misfit.with_prior(0.3)

    return wrong


@pytest.mark.parametrize("seed", range(3))
def test_it_comes_through_where_a_search_of_all_at_once_goes_astray(off, rattling, workshop, seed):
    misfit, true = off(seed), rattling.free_parameters()
    assert begin(workshop.identifier, misfit).advance(60).normalised > 10.0
    values = grown(workshop.identifier, misfit)
    assert begin(workshop.identifier, misfit.with_values(values)).normalised < 0.5  # the recordings have no noise
    for path in ("body.rear.mass", "joint.first.crush_force", "joint.second.elastic_stiffness"):
        assert values[path] == pytest.approx(true[path].value, rel=1e-2)


def test_what_it_was_never_shown_stays_as_it_was_given(off, workshop):
    """No joint of this motion is crushed so far."""
    misfit = off(0)
    path = "joint.second.densification_stiffness"
    assert grown(workshop.identifier, misfit)[path] == pytest.approx(misfit.values(misfit.start())[path], rel=1e-3)


def test_a_share_that_misleads_is_taken_again_by_halves_and_then_as_it_is(off, workshop, monkeypatch):
    asked = []
    up_to = Misfit.up_to

    def watched(misfit, share):
        asked.append(share)
        return up_to(misfit, share)

    monkeypatch.setattr(Misfit, "up_to", watched)
    nothing_fits = off(0).with_values(
        {"body.rear.mass": 1e3}, free=dict.fromkeys(off(0).names, False) | {"body.rear.mass": True}
    )
    grown(workshop.identifier, nothing_fits)
    *before, last = np.diff(asked)
    ahead = [step for step in before if step > 0.0]
    assert asked[-1] == 1.0
    assert len(ahead) < len(before)  # taken again
    assert min(ahead) == pytest.approx(LONGER * LEAST)  # after the least, which is always a step back


def test_a_search_that_is_lost_ends_where_it_still_understood_something(off, workshop, monkeypatch):
    """Here one that leaves twice the noise is."""
    misfit = off(0)
    nothing_fits = misfit.with_values(
        {"body.rear.mass": 1e3}, free=dict.fromkeys(misfit.names, False) | {"body.rear.mass": True}
    )
    to_the_end = grown(workshop.identifier, nothing_fits)
    monkeypatch.setattr(continuation, "LOST", 2.0)
    early = grown(workshop.identifier, nothing_fits)
    assert early["body.rear.mass"] != pytest.approx(to_the_end["body.rear.mass"], rel=1e-3)


def test_a_model_that_cannot_be_simulated_is_left_as_it_is(off, workshop, monkeypatch):
    def fail(self, scaled):
        raise SimulationError("the motion is not finite")

    monkeypatch.setattr(Misfit, "residual", fail)
    monkeypatch.setattr(Misfit, "residual_and_jacobian", fail)
    misfit = off(0)
    assert grown(workshop.identifier, misfit) == pytest.approx(misfit.values(misfit.start()))
