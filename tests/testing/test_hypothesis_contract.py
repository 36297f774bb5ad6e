"""The contract of hypotheses: a fault that it is there for is found."""

from typing import ClassVar

import numpy as np
import pytest
from attrs import evolve

from crashkit.mechanics import Simulator
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit.testing import HypothesisContract, toys

GAP = "joint.first.clearance"


class Gap(Hypothesis):
    """A hypothesis without fault; each test spoils one thing of its proposal."""

    physics: ClassVar[str] = "clearance"
    sentence: ClassVar[str] = "{place} engages only after a gap"
    spoilt: ClassVar[dict[str, object]] = {}

    def propose(self, model, motion, recordings):
        augmented = model.with_parameters({GAP: Parameter(0.0, 0.0, 0.5)})
        proposal = Proposal(self.physics, "gap", {"joint": "first"}, augmented, (GAP,), {GAP: 0.0}, ({GAP: 0.1},))
        return [evolve(proposal, **self.spoilt)]


class TestGap(HypothesisContract):
    @pytest.fixture
    def hypothesis(self):
        return Gap()


MODEL = toys.two_degrees()


def with_law(law, **numbers):
    """The proposed model with one more joint."""
    parameters = {name: Parameter(value) for name, value in numbers.items()}
    augmented = MODEL.with_parameters({GAP: Parameter(0.0, 0.0, 0.5)})
    return with_joint(augmented, Joint("layer", ("wall", "front"), law, parameters))


FAULTS = [
    ("test_proposals_bear_the_physics_and_a_form", {"physics": "gap"}, "expected clearance, found gap"),
    ("test_proposals_bear_the_physics_and_a_form", {"form": ""}, "the form of a proposal: expected a word, found none"),
    ("test_the_place_exists", {"location": {"joint": "third"}}, "joint: expected one of first, second, found third"),
    ("test_the_place_exists", {"location": {"bodies": ["wall", "door"]}}, "expected one of front, rear, wall, found door"),
    ("test_the_place_exists", {"location": {"place": "first"}}, "the location: expected one of joint, .* found {'place'"),
    ("test_the_place_exists", {"location": {"sensor": "roof", "instrument": "film"}}, "sensor: expected .* found roof"),
    ("test_the_new_parameters_are_free_and_new", {"model": MODEL}, f"expected {GAP} among the free parameters"),
    ("test_the_new_parameters_are_free_and_new", {"parameters": ()}, "expected new parameters, found none"),
    (
        "test_the_new_parameters_are_free_and_new",
        {"parameters": ("joint.first.crush_force",)},
        "joint.first.crush_force is free already in the given model",
    ),
    ("test_fits_start_within_bounds", {"starts": ({GAP: 0.7},)}, f"{GAP} starts outside its bounds, at 0.7"),
    ("test_fits_start_within_bounds", {"starts": ()}, "expected values to start from, found none"),
    ("test_the_null_is_of_the_new_parameters", {"null": {"body.front.mass": 0.0}}, "found body.front.mass"),
    (
        "test_every_model_can_be_simulated",
        {"null": {}, "model": with_law("origami")},
        'law: expected one of .* found "origami"',
    ),
    (
        "test_every_model_can_be_simulated",
        {"null": {}, "model": with_law("linear_stop")},
        'clearance .gap. at .*: joint "layer"/stiffness: expected a number in N m-1, found none',
    ),
    (
        "test_every_model_can_be_simulated",
        {"null": {}, "model": with_law("linear_stop", stiffness=1e300, stop_deformation=-1e9)},
        "clearance .gap. at .*: expected a model that can be simulated, found ",
    ),
    ("test_at_its_null_the_physics_is_absent", {"null": {GAP: 0.1}}, "expected the readings of the given model, found a diff"),
]


@pytest.fixture(scope="module")
def motion():
    return [Simulator(MODEL, load().spring_laws).run(np.linspace(0.0, 0.2, 51))]


@pytest.mark.parametrize(("test", "spoilt", "message"), FAULTS, ids=[f"{n}-{row[0]}" for n, row in enumerate(FAULTS)])
def test_a_fault_is_found(motion, test, spoilt, message):
    recordings = {"run": toys.recording(motion[0])}
    hypothesis = type("Spoilt", (Gap,), {"spoilt": spoilt})()
    given = {"hypothesis": hypothesis, "model": MODEL, "motion": motion, "recordings": recordings}
    given["proposals"] = hypothesis.propose(MODEL, motion, list(recordings.values()))
    method = getattr(HypothesisContract(), test)
    names = method.__code__.co_varnames[1 : method.__code__.co_argcount]
    with pytest.raises((AssertionError, pytest.fail.Exception), match=message):
        method(**{name: given[name] for name in names})


def test_a_hypothesis_without_a_proposal_is_found():
    with pytest.raises(AssertionError, match="expected a proposal for this model and these recordings, found none"):
        HypothesisContract().test_proposes_something([])


def test_a_sentence_without_a_place_is_found():
    with pytest.raises(AssertionError, match='the sentence: expected "{place}" in it, found "there is a gap"'):
        HypothesisContract().test_the_sentence_takes_a_place(type("Mute", (Gap,), {"sentence": "there is a gap"})())
