"""A force that a search has driven to nothing makes a gap, which the model does not have."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.vanished import told_by_vanished, vanished_at
from crashkit.mechanics import Simulator
from crashkit.model import Joint, Parameter
from crashkit.testing import toys

GAP = 0.05
DEFORMATION, FORCE = (0.05, 0.2, 0.35), (5e4, 6e4, 7e4)
"""m, N: the corners are on a line, so one of them is to spare."""
BENT = {"deformation[0]": GAP, "deformation[1]": 0.05 + GAP, "deformation[2]": 0.35 + GAP, "force[0]": 10.0, "force[1]": 5e4}
"""With the gap before them, from the first corner on."""


def curved(gap=0.0):
    toy = toys.two_degrees()
    toy = toy.with_parameters({path: evolve(p, fixed=True) for path, p in toy.parameters().items()})
    corners = {"deformation": tuple(map(Parameter, DEFORMATION)), "force": tuple(map(Parameter, FORCE))}
    numbers = corners | {
        "final_stiffness": Parameter(1e6),
        "unloading_stiffness": Parameter(3e6),
        "clearance": Parameter(gap, fixed=True),
    }
    return evolve(toy, joints=(toy.joints[0], Joint("second", toy.joints[1].bodies, "piecewise_affine", numbers)))


@pytest.fixture
def told(workshop, inquiry):
    """A model whose joint has no gap, and what is told of it where a search ended near these numbers."""

    def tell(gap, numbers):
        here = workshop.equipped([curved()])
        recordings = {f"run_{speed}": recorded(here, curved(gap), speed) for speed in (0.9, 1.3)}
        given = here.first_misfit(curved(), recordings).with_prior(0.3)
        bent = given.with_values({f"joint.second.{name}": value for name, value in numbers.items()})
        base = begin(here.identifier, bent).advance(60)
        asked = evolve(inquiry(base, given=given), workshop=here)
        return given, base, told_by_vanished(asked, Discovery.of(base, base))

    return tell


def recorded(workshop, model, speed):
    times = np.arange(1201) * 2.5e-4
    simulator = Simulator(model, workshop.laws, workshop.engine)
    return toys.recording(simulator.run(times, initial=toys.initial_state(model, speed)))


def test_a_gap_behind_a_force_that_has_vanished(told):
    given, base, found = told(GAP, BENT)
    assert vanished_at(given, base) == ["second"]
    assert base.normalised < 1.1
    (look,) = found.findings
    assert look.leader.identity == ("clearance", "joint second")
    assert found.search.values["joint.second.clearance"] == pytest.approx(GAP, rel=0.1)
    assert vanished_at(given, found.search) == []


def test_numbers_that_are_there_hide_nothing(told):
    given, base, found = told(0.0, {})
    assert vanished_at(given, base) == []
    assert found.findings == ()
