"""Linkages: a joint that two bodies deform and whose force acts on two others; and one whose force another joint drives."""

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
STAGES = np.linspace(0.0, 0.08, 161)
HEIGHTS = 0.3, -0.2, 0.5, 0.4
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


@pytest.fixture
def driven(car):
    """Of the model that has everything: what is between the two bodies is driven by what is in front of them."""

    def of(axes):
        model = car(axes)
        numbers = {"driver_reach": Parameter(0.2), "driver_heights": tuple(map(Parameter, HEIGHTS))}
        line = model.joint("line")
        line = evolve(line, factors=("driven_curve",), driver="face", parameters={**line.parameters, **numbers})
        return evolve(model, joints=tuple(line if joint.name == "line" else joint for joint in model.joints))

    return of


def factor(deformation):
    """Of the fixture's numbers, written out."""
    share = deformation / 0.2
    place = 4 * 0.5 * (share + 1.0 - np.sqrt((share - 1.0) ** 2 + 0.02**2))
    return 1.0 + sum(height * np.exp(-(((place - i - 0.5) / 0.8) ** 2)) for i, height in enumerate(HEIGHTS))


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_a_driven_factor_multiplies_the_force_by_what_the_other_joint_says(driven, car, laws, simulator, axes):
    """The law alone, along the same motion, gives the rest."""
    motion = simulator(driven(axes)).run(STAGES)
    says = factor(motion["deformation"].sel(joint="face").values)
    assert np.ptp(says) > 0.3
    expected = says * forces_along(car(axes), laws, motion)["force"].sel(joint="line").values
    np.testing.assert_allclose(motion["force"].sel(joint="line"), expected, atol=1e-3 * expected.max())
    along = forces_along(driven(axes), laws, motion)["force"].sel(joint="line").values
    np.testing.assert_allclose(along, expected, rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_its_sensitivities_agree_with_differences_and_the_adjoint_with_them(driven, simulator, check_adjoint, axes):
    own, model = simulator(driven(axes)), driven(axes)
    paths = ["joint.line.driver_heights[2]", "joint.face.crush_force", "joint.line.crush_force", "body.front.mass"]
    end = "joint.face.points[1]" if axes == 1 else "joint.face.points[1][0]"
    check_adjoint(own, STAGES, [*paths, end], close=1e-11)
    slopes = own.run(STAGES, sensitivities=paths)["position_sensitivity"]
    for path in paths:
        value = model.parameters()[path].value
        above, below = (own.run(STAGES, {path: value * (1.0 + h)})["position"] for h in (1e-5, -1e-5))
        expected = (above - below) / (2e-5 * value)
        np.testing.assert_allclose(slopes.sel(parameter=path), expected, atol=1e-5 * float(np.abs(expected).max()))


def test_the_state_form_knows_what_drives_a_joint(driven, laws, simulator):
    model = driven(1)
    motion = simulator(model).run(np.linspace(0.0, 0.08, 1601))
    form = state_form(model, laws, motion)
    told, felt = (one["acceleration"].sel(body=["front", "rear"]) for one in (form, motion))
    np.testing.assert_allclose(told, felt, atol=1e-3 * float(np.abs(felt).max()))


@pytest.mark.parametrize("driver", ["", "line", "roof"])
def test_what_drives_it_is_checked(driven, laws, driver):
    model = driven(1)
    joints = tuple(evolve(joint, driver=driver) if joint.name == "line" else joint for joint in model.joints)
    expected = f'joint "line"/driver: expected one of the other joints .*"driven_curve" depends on, found "{driver}"'
    with pytest.raises(ContractError, match=expected):
        check_model(evolve(model, joints=joints), laws, "linked")


@pytest.mark.parametrize(
    ("pair", "found"),
    [(("front", "roof"), r'expected one of .*, found "roof"'), (("rear", "rear"), '"rear" twice')],
)
def test_what_it_acts_on_is_checked(linked, laws, pair, found):
    wrong = evolve(linked, joints=(*linked.joints[:2], evolve(linked.joints[2], acts_on=pair)))
    with pytest.raises(ContractError, match=f'joint "wedge"/acts_on: .*{found}'):
        check_model(wrong, laws, "linked")
