"""One engine for every model that a diagnosis tries."""

import numpy as np
from attrs import evolve

from crashkit.model import Parameter
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
