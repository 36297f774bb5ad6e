"""One form is brought near another by its forces alone."""

import numpy as np
import pytest

from crashkit.diagnose.name import force_matching
from crashkit.diagnose.name.force_matching import most_alike
from crashkit.mechanics.along import forces_along
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint


@pytest.fixture
def stopped(model):
    """The model with a stop of some kind in parallel."""

    def stop(law, **numbers):
        return with_joint(model, Joint("stop", ("wall", "front"), law, numbers))

    return stop


def test_a_stop_gets_the_force_of_another_kind(workshop, misfit, recorded, stopped):
    present = stopped("linear_stop", stiffness=Parameter(8e4, fixed=True), stop_deformation=Parameter(0.5, fixed=True))
    other = stopped("quadratic_stop", coefficient=Parameter(0.0, 0.0, 1e12), stop_deformation=Parameter(0.2, 0.0, 1.0))
    equipped = workshop.equipped([present, other])
    known = equipped.first_misfit(present, {"run": recorded(present)})
    begun = equipped.first_misfit(other, {"run": recorded(present)})
    values = most_alike(known, begun, ["joint.stop.coefficient", "joint.stop.stop_deformation"], workshop.laws)
    motion = known.predictor.motion("run", known.values(known.start()))
    wanted, first, found = (
        forces_along(one, workshop.laws, motion)["force"].sel(joint="stop").values
        for one in (present, other, other.with_values(values))
    )
    assert np.linalg.norm(found - wanted) < 0.1 * np.linalg.norm(first - wanted)
    assert {name: value for name, value in values.items() if "stop." not in name} == {
        name: value for name, value in begun.values(begun.start()).items() if "stop." not in name
    }


def test_numbers_whose_bounds_leave_no_room_stay(workshop, recorded, stopped):
    present = stopped("linear_stop", stiffness=Parameter(8e4, fixed=True), stop_deformation=Parameter(0.5, fixed=True))
    other = stopped("quadratic_stop", coefficient=Parameter(0.0, 0.0, 0.0), stop_deformation=Parameter(0.2, 0.2, 0.2))
    equipped = workshop.equipped([present, other])
    known, begun = (equipped.first_misfit(one, {"run": recorded(present)}) for one in (present, other))
    names = ["joint.stop.coefficient", "joint.stop.stop_deformation"]
    assert most_alike(known, begun, names, workshop.laws) == begun.values(begun.start())


def test_slopes_are_those_of_the_forces(workshop, stopped, recorded):
    model = stopped("quadratic_stop", coefficient=Parameter(3e6, 0.0, 1e12), stop_deformation=Parameter(0.2, 0.0, 1.0))
    known = workshop.equipped([model]).first_misfit(model, {"run": recorded(model)})
    names, motions = ["joint.stop.coefficient", "joint.stop.stop_deformation"], force_matching._motions(known)
    tracks = force_matching._tracks(known, {frozenset(("wall", "front"))}, workshop.laws, motions)
    stills = [np.zeros((*motion["position"].shape[:2], 1)) for motion in motions]
    slopes = force_matching._slopes(known, tracks, stills, {}, names)
    for column, name in enumerate(names):
        value = model.values()[name]
        less, more = (force_matching._forces(known, tracks, stills, {name: value * (1.0 + h)}) for h in (-1e-6, 1e-6))
        expected = (more - less) / (2e-6 * value)
        assert np.abs(expected).max() > 0.0
        assert slopes[:, column] == pytest.approx(expected, rel=1e-4, abs=1e-6 * np.abs(expected).max())


def test_what_has_no_force_is_left_where_it_is(workshop, misfit, model, recorded):
    weighed = model.with_parameters({"body.front.mass": Parameter(1000.0, 500.0, 2000.0)})
    known = misfit(weighed, run=recorded(model))
    assert most_alike(known, known, ["body.front.mass"], workshop.laws) == known.values(known.start())
