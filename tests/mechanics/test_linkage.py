"""A linkage: a joint that two bodies deform and whose force acts on two others."""

import numpy as np
import pytest
from attrs import evolve
from scipy.integrate import solve_ivp

from crashkit.errors import ContractError
from crashkit.mechanics.along import forces_along
from crashkit.mechanics.state_form import state_form
from crashkit.model import Body, Model, Parameter
from crashkit.model.checks import check_model

TIMES = np.linspace(0.0, 1.2, 241)
FRONT, REAR, LINK = 4.0, 3.0, 1.5
"""N/m."""


@pytest.fixture
def linked(joint):
    """Two masses on linear springs; what deforms the front one also pushes the two masses apart."""
    bodies = (
        Body("wall", (0.0,), (0.0,), fixed=True),
        Body("front", (-1.0,), (1.0,), Parameter(0.5)),
        Body("rear", (-2.0,), (1.0,), Parameter(1.0)),
    )
    joints = (
        joint("nose", ("wall", "front"), "linear_stop", {"stiffness": FRONT, "stop_deformation": 0.0}),
        joint("mount", ("front", "rear"), "linear_stop", {"stiffness": REAR, "stop_deformation": 0.0}),
        joint(
            "wedge",
            ("wall", "front"),
            "linear_stop",
            {"stiffness": LINK, "stop_deformation": 0.0},
            acts_on=("front", "rear"),
            free_length=Parameter(1.0),
        ),
    )
    return Model("linked", ("x",), bodies, joints)


def test_its_motion_is_that_of_the_equations_written_out(linked, simulator):
    def rates(t, state):
        front, rear, *speeds = state
        nose, mount = front + 1.0, rear - front + 1.0
        between = REAR * mount + LINK * nose
        return [*speeds, (-FRONT * nose + between) / 0.5, -between / 1.0]

    known = solve_ivp(rates, (0.0, TIMES[-1]), [-1.0, -2.0, 1.0, 1.0], t_eval=TIMES, rtol=1e-11, atol=1e-12)
    motion = simulator(linked).run(TIMES)
    assert float(motion["deformation"].min()) > -1e-12  # linear springs only push
    np.testing.assert_allclose(motion["position"].sel(body=["front", "rear"]).values[..., 0], known.y[:2].T, atol=1e-8)
    np.testing.assert_allclose(motion["deformation"].sel(joint="wedge"), motion["deformation"].sel(joint="nose"))
    push = FRONT * (known.y[0] + 1.0)
    np.testing.assert_allclose(motion["contact_force"].sel(body="wall").values[:, 0], push, atol=1e-7)


def test_its_sensitivities_agree_with_differences_and_with_the_adjoint(linked, simulator, check_adjoint):
    own = simulator(linked)
    paths = [
        "joint.wedge.stiffness",
        "joint.nose.stiffness",
        "body.rear.mass",
        "body.front.velocity",
        "joint.wedge.free_length",
    ]
    check_adjoint(own, TIMES, paths)
    slopes = own.run(TIMES, sensitivities=paths[:3])["position_sensitivity"]
    for path in paths[:3]:
        value = linked.parameters()[path].value
        above, below = (own.run(TIMES, {path: value * (1.0 + h)})["position"] for h in (1e-5, -1e-5))
        np.testing.assert_allclose(slopes.sel(parameter=path), (above - below) / (2e-5 * value), atol=1e-7)


def test_along_a_motion_and_in_the_state_form_it_is_the_same(linked, laws, simulator):
    motion = simulator(linked).run(TIMES)
    along = forces_along(linked, laws, motion[["position", "velocity"]])
    np.testing.assert_allclose(along["contact_force"], motion["contact_force"], atol=1e-9)
    np.testing.assert_allclose(state_form(linked, laws, motion)["acceleration"], motion["acceleration"], atol=1e-9)


@pytest.mark.parametrize(
    ("pair", "found"),
    [(("front", "roof"), r'expected one of .*, found "roof"'), (("rear", "rear"), '"rear" twice')],
)
def test_what_it_acts_on_is_checked(linked, laws, pair, found):
    wrong = evolve(linked, joints=(*linked.joints[:2], evolve(linked.joints[2], acts_on=pair)))
    with pytest.raises(ContractError, match=f'joint "wedge"/acts_on: .*{found}'):
        check_model(wrong, laws, "linked")
