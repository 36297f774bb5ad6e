"""The equations that a filter enters anywhere, of a model with both kinds of linkage: the engine's, and differences."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.api import workshop
from crashkit.mechanics import Simulator
from crashkit.model import Joint, Parameter
from crashkit.model.edit import with_joint
from crashkit.testing import toys
from crashkit_identifiers.line_dynamics import LineDynamics

MOVING = ["front", "rear"]


@pytest.fixture(scope="module")
def linked():
    """Two masses; the first joint's deformation pushes them apart, and multiplies the force of the second."""
    stop = {"stiffness": Parameter(3e4), "stop_deformation": Parameter(0.0, fixed=True)}
    wedge = Joint("wedge", ("wall", "front"), "linear_stop", stop, acts_on=("front", "rear"))
    model = with_joint(toys.two_degrees(), wedge)
    heights = {"driver_heights": tuple(map(Parameter, (0.3, -0.2, 0.5, 0.4))), "driver_reach": Parameter(0.5, fixed=True)}
    second = model.joint("second")
    driven = evolve(second, factors=("driven_curve",), driver="first", parameters={**second.parameters, **heights})
    return evolve(model, joints=(model.joint("first"), driven, model.joint("wedge")))


@pytest.fixture(scope="module")
def reaching(linked):
    """Its second joint holds the front where that reaches behind the rear."""
    second = evolve(linked.joint("second"), points=((-3.0,), (0.0,)))
    return evolve(linked, joints=(linked.joint("first"), second, linked.joint("wedge")))


@pytest.mark.parametrize("name", ["linked", "reaching"])
def test_accelerations_are_the_engines_and_their_derivatives_are_right(name, request):
    linked = request.getfixturevalue(name)
    shop = workshop().rehearsed(toys.two_degrees(), []).equipped([linked])
    simulator = Simulator(linked, shop.laws, shop.engine)
    motion = simulator.run(np.arange(301) * 1e-3, initial=toys.initial_state(linked, 1.0))
    misfit = shop.first_misfit(linked, {"run": toys.recording(motion)})
    dynamics, at = LineDynamics(misfit, motion), motion.sel(body=MOVING).isel(time=120, axis=0)
    state = np.concatenate([at["position"].values, at["velocity"].values])
    values = {path: parameter.value for path, parameter in linked.parameters().items()}
    found, by_state, _ = dynamics._accelerations(state, values)
    assert found == pytest.approx(at["acceleration"].values, rel=1e-9)
    above, below = ([dynamics._accelerations(state + sign * 1e-6 * e, values)[0] for e in np.eye(4)] for sign in (1.0, -1.0))
    expected = np.subtract(above, below).T / 2e-6
    assert by_state == pytest.approx(expected, abs=1e-7 * float(np.abs(expected).max()))
