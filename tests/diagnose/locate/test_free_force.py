"""The place that the equations of motion point to, whatever law acts there."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.locate.free_force import FreeForce, free_forces, outstanding
from crashkit.diagnose.name.explore import _where_it_acts
from crashkit.diagnose.name.follow import Discovery
from crashkit.diagnose.name.look import Look
from crashkit.diagnose.result import place_of
from crashkit.errors import CrashkitError
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Proposal
from crashkit.testing import toys


class NoMotion:
    """An identifier that finds no motion measured."""

    def start(self, misfit):
        raise CrashkitError("expected film or accelerometers")

    def equations(self, misfit, state):
        """Of nothing."""


@pytest.fixture
def given(misfit, recorded):
    """Two bodies as they are believed, and recordings of what a push by the clock in one joint does, another in each run."""

    def of(name):
        believed, (end, other) = toys.two_degrees(), toys.two_degrees().joint(name).bodies
        runs = {}
        for run, (speed, height) in enumerate(((0.9, 3e4), (1.2, -2e4))):
            heights = tuple(Parameter(height * np.sin(0.7 * knot + run), fixed=True) for knot in range(24))
            push = {"heights": heights, "duration": Parameter(0.3, fixed=True)}
            true = with_joint(believed, Joint("push", (end, other), "time_table", push))
            runs[f"run{run}"] = recorded(true, speed, run, accelerometer=lambda felt: felt.isel(time=slice(None, None, 4)))
        return misfit(believed, **runs).with_prior(0.15)

    return of


def test_no_law_and_no_two_runs_alike_and_yet_the_place_is_told(workshop, given):
    """The joint between the bodies: a force on one of them leaves the other's motion as it is."""
    found = free_forces(workshop, given("second"))
    assert found[0].left == min(one.left for one in found)
    assert place_of(outstanding(found).first.proposal.location) == "joint second"


def test_a_force_between_a_body_and_the_ground_is_told_by_the_joint_that_may_carry_it(workshop, given):
    assert place_of(outstanding(free_forces(workshop, given("first"))).first.proposal.location) == "joint first"


def test_where_no_motion_was_measured_nothing_is_told(workshop, given):
    unseen = evolve(workshop, locator=NoMotion())
    assert free_forces(unseen, given("second")) == []


def course(place, left):
    """At a joint."""
    return FreeForce(Proposal("unknown", "time", {"joint": place}, toys.two_degrees(), (), {}, estimate_of="time"), left)


@pytest.mark.parametrize(
    ("left", "first"),
    [
        ({"a": 100.0, "b": 300.0}, "joint a"),
        ({"a": 100.0, "b": 120.0}, None),
        ({"a": 100.0, "same": 100.001, "b": 300.0}, "joint a"),
        ({"a": 100.0, "same": 100.001, "b": 120.0}, None),
        ({"a": 100.0}, None),
        ({}, None),
    ],
)
def test_a_place_stands_out_where_all_others_leave_much_more(left, first):
    found = outstanding([course(place, one) for place, one in left.items()])
    assert (place_of(found.first.proposal.location) if found else None) == first


def test_a_place_is_told_with_the_next_best():
    pointer = outstanding([course("a", 100.0), course("same", 100.001), course("b", 400.0)])
    assert str(pointer) == (
        "the equations of motion point to joint a: a single force there, of another course in each run, would leave 25% of "
        "what one at joint b would"
    )


@pytest.mark.parametrize(
    ("named", "place", "times", "first"),
    [
        ("peak_load", {"joint": "first"}, 1.0, ("unknown", "joint second")),
        ("peak_load", {"joint": "first"}, 2.0, ("unknown", "joint second")),
        ("peak_load", {"joint": "first"}, 3.0, ("peak_load", "joint first")),
        ("peak_load", {"joint": "second"}, 1.0, ("peak_load", "joint second")),
        ("bias", {"sensor": "front_sensor"}, 1.0, ("bias", "sensor front_sensor")),
    ],
)
def test_what_leaves_something_elsewhere_gives_way_to_an_estimate_there(workshop, inquiry, given, named, place, times, first):
    """But not to one that leaves much more, and not what is named at that place, nor what is said of an instrument."""
    one = given("second")
    search = begin(workshop.identifier, one)
    table = next(p for p in propose_all(workshop, one) if (p.physics, p.location) == ("unknown", {"joint": "second"}))
    claim = evolve(table, physics=named, location=place)
    estimate = begin(workshop.identifier, workshop.misfit(one, table.model))
    estimate = evolve(estimate, state=evolve(estimate.state, cost=times**2 * search.state.cost))
    rivals = (Rival(claim, search, 100.0, 50.0), Rival(table, estimate, 90.0, 40.0))
    look = Look(rivals, (0.9, 0.1), 0.0, one)
    found = _where_it_acts(inquiry(search), Discovery(one, one, search, (look,)))
    assert found.findings[0].leader.identity == first
    assert found.findings[0].probabilities[0] == max(found.findings[0].probabilities) > 0.5
    assert (found.pointer is not None) is (first[0] == "unknown")
    assert found.search is (estimate if first[0] == "unknown" else search)
