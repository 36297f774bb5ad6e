"""One engine for every model that a diagnosis tries."""

import re
import warnings

import numpy as np
import pytest
from attrs import evolve

from crashkit.diagnose.claims import propose_all
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit.testing import toys

SHARE, LINES = "piecewise_affine % plastic_share", "piecewise_affine / second_line"


def test_the_engine_holds_the_laws_of_all_claims_before_any_is_made(workshop):
    """Among them those of a contact, which only bodies that come nearer to each other ask for."""
    laws = {function.law.name for function in workshop.engine.codes}
    assert {"crush_stop", "dahl", "maxwell", "coulomb", "crush_plateau + folding", "viscous_power"} <= laws


def laws_of_unloading(workshop, corners):
    """What is brought to a joint with a curve of so many corners."""
    curve = {
        name: tuple(map(Parameter, top * np.arange(1.0, corners + 1.0)))
        for name, top in (("deformation", 0.01), ("force", 1e3))
    }
    numbers = {**curve, "final_stiffness": Parameter(1e5), "unloading_stiffness": Parameter(0.0)}
    model = toys.one_degree()
    curved = evolve(model, joints=(evolve(model.joints[0], law="piecewise_affine", parameters=numbers),))
    unloading = {"plastic_unloading": workshop.hypotheses["plastic_unloading"]}
    engine = evolve(workshop, engine=None, hypotheses=unloading).rehearsed(curved, []).engine
    assert not engine.opaque
    return {function.law.name for function in engine.codes}


def test_a_form_for_which_a_long_curve_has_no_room_is_not_asked_for(workshop):
    short = laws_of_unloading(workshop, 8)
    assert {"piecewise_affine", SHARE, LINES, f"{LINES} % plastic_share"} <= short
    assert laws_of_unloading(workshop, 16) == short - {f"{LINES} % plastic_share"}
    assert laws_of_unloading(workshop, 26).isdisjoint({f"{LINES} % plastic_share", SHARE, LINES})


def test_a_law_that_would_have_to_be_compiled_first_is_not_held(workshop):
    model = toys.two_degrees()
    first = model.joint("first")
    other = evolve(first, law=f"{first.law} + linear_stop | maxwell & viscous")
    assert workshop.holds(model)
    assert not workshop.holds(evolve(model, joints=(other, *model.joints[1:])))
    assert not evolve(workshop, engine=None).holds(model)


GAP = "joint.first.clearance"


def gap(model, /, **changed):
    """A proposal as it should be, but for these attributes."""
    augmented = model.with_parameters({GAP: Parameter(0.0, 0.0, 0.5)})
    return evolve(Proposal("layer", "gap", {"joint": "first"}, augmented, (GAP,), {GAP: 0.0}, ({GAP: 0.1},)), **changed)


def beside(model, law, **parameters):
    return with_joint(model, Joint("layer", ("wall", "front"), law, {name: Parameter(1.0) for name in parameters}))


FAULTY = {
    "raises": (lambda model: 1 / 0, "propose raised ZeroDivisionError: division by zero"),
    "returns nothing": (lambda model: None, "propose: expected a list of proposals, found None"),
    "proposes a model": (lambda model: [model], "propose: expected proposals of models, found Model"),
    "another's physics": (
        lambda model: [gap(model, physics="clearance")],
        'propose: expected proposals of "layer", found one of "clearance"',
    ),
    "a wrong path": (
        lambda model: [gap(model, parameters=("joint.first.gap",))],
        'a proposal (gap): expected parameters of its model, and those that are new free, found "joint.first.gap"',
    ),
    "a parameter that is not free": (
        lambda model: [gap(model, model=model)],
        f'a proposal (gap): expected parameters of its model, and those that are new free, found "{GAP}"',
    ),
    "a law that does not exist": (
        lambda model: [gap(model, model=beside(gap(model).model, "log_foam", force=1.0))],
        "joint layer: expected one of the installed laws (",
    ),
    "a law without its parameter": (
        lambda model: [gap(model, model=beside(gap(model).model, "linear_stop"))],
        'a proposal (gap): joint "layer"/stiffness: expected a number in N m-1, found none',
    ),
}


@pytest.mark.parametrize("fault", FAULTY)
def test_a_hypothesis_that_fails_is_left_out_and_told_once(workshop, model, misfit, recorded, fault):
    propose, message = FAULTY[fault]
    faulty = type("Layer", (Hypothesis,), {"physics": "layer", "propose": lambda self, model, *_: propose(model)})
    two = {"layer": faulty, "clearance": workshop.hypotheses["clearance"]}
    with pytest.warns(UserWarning, match="left out") as told:
        equipped = evolve(workshop, hypotheses=two, failed=set()).rehearsed(model, [])
    (warning,) = told
    assert re.fullmatch(rf"hypothesis layer of \S+: {re.escape(message)}.*; left out", str(warning.message))
    assert {p.physics for p in propose_all(equipped, misfit(model, run=recorded(model)))} == {"clearance"}
    assert workshop.failed == set()


def test_a_hypothesis_that_fails_later_is_left_out_from_then_on(workshop, model, misfit, recorded):
    """What a rehearsal asks for need not be what a motion does."""
    rest = {"layer": type("Layer", (Hypothesis,), {"physics": "layer", "propose": lambda self, model, *_: [gap(model)]})}
    equipped = evolve(workshop, hypotheses=rest, failed=set()).rehearsed(model, [])
    base = misfit(model, run=recorded(model))
    assert [p.form for p in propose_all(equipped, base)] == ["gap"]
    rest["layer"].propose = lambda self, *_: {}["peak"]
    with pytest.warns(UserWarning, match="^hypothesis layer of .*: propose raised KeyError: 'peak'; left out$"):
        assert propose_all(equipped, base) == []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert propose_all(evolve(equipped, step=1e-4), base) == []


def test_a_plugin_is_told_by_its_distribution(workshop, model, monkeypatch):
    monkeypatch.setattr(workshop.hypotheses["clearance"], "propose", lambda self, *_: None)
    few = evolve(workshop, hypotheses={"clearance": workshop.hypotheses["clearance"]}, failed=set())
    with pytest.warns(
        UserWarning, match="^hypothesis clearance of crashkit-hypotheses: propose: expected a list of proposals"
    ):
        assert few.proposals(model, [], []) == []
