"""The adjoint: the transpose of the forward sensitivities, in every geometry and to every kind of parameter."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.model import Parameter

TIMES = np.linspace(0.0, 0.08, 33)


def every_path(model, axes):
    index = [""] if axes == 1 else [f"[{i}]" for i in range(axes)]
    spin = {1: [], 2: [""], 3: ["[0]", "[1]", "[2]"]}[axes]
    yield from (path for path, entry in model.parameters().items() if entry.value)
    for body in ("wall", "front", "rear"):
        yield from (f"body.{body}.{name}{i}" for name in ("position", "velocity") for i in index)
        yield from (f"body.{body}.{name}{i}" for name in ("rotation", "angular_velocity") for i in spin)
    yield from (f"joint.{joint}.points[{end}]{i}" for joint in ("face", "line", "stop") for end in (0, 1) for i in index)


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_it_is_the_transpose_of_the_sensitivities(simulator, car, check_adjoint, axes):
    model = car(axes)
    check_adjoint(simulator(model), TIMES, list(every_path(model, axes)))


MEMBERS = {
    "brittle": {"stiffness": 2e5, "fracture_deformation": 0.1, "loss": 0.6},
    "maxwell": {"relaxing_stiffness": 2e5, "relaxation_time": 0.02},
}


@pytest.mark.parametrize("law", MEMBERS)
@pytest.mark.parametrize("axes", [1, 2, 3])
def test_a_member_that_breaks_or_remembers(simulator, car, check_adjoint, axes, law):
    """In a model that has everything; the force jumps at 0.1 m."""
    model = car(axes)
    values = {name: Parameter(value) for name, value in MEMBERS[law].items()}
    member = evolve(model.joints[2], law=law, factors=(), parameters=values)
    model = evolve(model, joints=(*model.joints[:2], member, model.joints[3]))
    assert float(simulator(model).run(TIMES)["deformation"].sel(joint="stop").max()) > 0.11
    check_adjoint(simulator(model), TIMES, list(every_path(model, axes)), close=1e-11)


def test_the_gradient_of_a_misfit_agrees_with_differences(simulator, car):
    """Of the sum of squares of the front's displacement, to all of the model's free parameters."""
    own = simulator(car(1))
    motion = own.run(TIMES)
    gradient = own.adjoint(TIMES, motion[["position"]] * 2.0)
    for path in ("joint.face.crush_force", "joint.line.elastic_stiffness", "joint.stop.stop_deformation", "body.rear.mass"):
        value = own.model.parameters()[path].value
        above, below = (float((own.run(TIMES, {path: value * (1.0 + h)})["position"] ** 2).sum()) for h in (1e-5, -1e-5))
        assert float(gradient.sel(parameter=path)) == pytest.approx((above - below) / (2e-5 * value), rel=1e-6), path


def test_a_quantity_that_a_motion_does_not_have(simulator, car):
    own = simulator(car(1))
    weights = own.run(TIMES)[["position"]].rename(position="colour")
    with pytest.raises(CrashkitError, match="expected weights of deformation.*, found colour"):
        own.adjoint(TIMES, weights)
