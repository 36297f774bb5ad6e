"""Forces along a given motion: those of the simulator along its own, and of plain arithmetic along any other."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.mechanics.along import forces_along
from crashkit.model import Body, Model, Parameter
from crashkit.model.edit import with_joint

CRUSH = {
    "elastic_stiffness": 1.2,
    "crush_force": 0.24,
    "densification_deformation": 0.6,
    "densification_stiffness": 1.2,
    "unloading_stiffness": 6.0,
    "rate_coefficient": 0.0,
    "clearance": 0.1,
    "tension": 0.0,
}


@pytest.fixture
def chain(joint):
    """Two masses, three joints, a rate factor, attachment points and a free length of its own."""
    bodies = (
        Body("wall", (0.0,), (0.0,), fixed=True),
        Body("engine", (-1.0,), (1.0,), Parameter(0.3)),
        Body("car", (-2.0,), (1.0,), Parameter(1.0)),
    )
    crush = joint("front", ("wall", "engine"), "crush_plateau", CRUSH)
    joints = (
        evolve(crush, factors=("rate_linear",), parameters={**crush.parameters, "rate_slope": Parameter(0.3)}),
        joint("side", ("car", "wall"), "linear_stop", {"stiffness": 0.8, "stop_deformation": 0.05}),
        joint(
            "mount",
            ("engine", "car"),
            "viscous",
            {"damping": 0.2, "clearance": 0.0, "engagement": 1e-3},
            points=((-0.2,), (0.3,)),
            free_length=Parameter(0.6),
        ),
    )
    return Model("chain", ("x",), bodies, joints)


@pytest.mark.parametrize("quantity", ["deformation", "deformation_rate", "force", "contact_force"])
def test_along_its_own_motion_the_forces_are_the_simulators(chain, laws, simulator, quantity):
    motion = simulator(chain).run(np.linspace(0.0, 3.0, 3001))
    along = forces_along(chain, laws, motion[["position", "velocity"]])
    assert along[quantity].dims == motion[quantity].dims
    scale = float(np.abs(motion[quantity]).max())
    # Between the instants a joint may turn round, so that the largest deformation is known to a hundredth of a per cent.
    assert along[quantity].values == pytest.approx(motion[quantity].values, abs=1e-4 * scale)


@pytest.mark.parametrize("axes", [2, 3])
def test_so_they_are_in_the_plane_and_in_space(car, laws, simulator, axes):
    model = car(axes)
    motion = simulator(model).run(np.linspace(0.0, 0.08, 1601))
    along = forces_along(model, laws, motion[["position", "velocity", "orientation", "angular_velocity"]])
    for quantity in ("deformation", "deformation_rate", "force", "contact_force", "contact_moment"):
        assert along[quantity].dims == motion[quantity].dims
        scale = float(np.abs(motion[quantity]).max())
        assert along[quantity].values == pytest.approx(motion[quantity].values, abs=1e-3 * scale), quantity


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_what_a_law_remembers_is_known_to_the_sampling_of_the_motion(car, laws, simulator, axes):
    relaxing = {"relaxing_stiffness": Parameter(1e6), "relaxation_time": Parameter(0.01)}
    model = with_joint(car(axes), evolve(car(axes).joint("line"), name="relaxing", law="maxwell", parameters=relaxing))
    motion = simulator(model).run(np.linspace(0.0, 0.08, 1601))
    known = motion["force"].sel(joint="relaxing").values
    assert known.max() > 1e4
    along = forces_along(model, laws, motion)["force"].sel(joint="relaxing").values
    assert along == pytest.approx(known, abs=1e-4 * known.max())


def test_the_points_say_on_which_side_a_joint_pushes(against_wall, laws, simulator):
    """A mass that stands before the wall and reaches around it."""
    model = against_wall("linear_stop", {"stiffness": 1.3, "stop_deformation": 0.0}, speed=-1.0)
    model = evolve(model, joints=(evolve(model.joints[0], points=((0.0,), (1.5,))),))
    motion = simulator(model).run(np.linspace(0.0, 1.0, 101))
    along = forces_along(model, laws, motion)
    assert motion["joint_side"].values.tolist() == [1.0]
    assert float(motion["force"].max()) > 0.1
    for quantity in along:
        np.testing.assert_allclose(along[quantity], motion[quantity], atol=1e-9)


def test_a_recorded_motion_needs_no_simulation(joint, against_wall, laws):
    model = against_wall("linear_stop", {"stiffness": 100.0, "stop_deformation": 0.1})
    position = np.array([-1.0, -0.95, -0.7, -0.9])
    motion = xr.Dataset(
        {
            "position": (("time", "body", "axis"), np.stack([np.zeros(4), position], axis=1)[:, :, None]),
            "velocity": (("time", "body", "axis"), np.zeros((4, 2, 1))),
        },
        coords={"time": [0.0, 0.1, 0.2, 0.3], "body": ["wall", "mass"], "axis": ["x"]},
    )
    along = forces_along(model, laws, motion)
    assert along["deformation"].sel(joint="spring").values == pytest.approx([0.0, 0.05, 0.3, 0.1])
    assert along["force"].sel(joint="spring").values == pytest.approx([0.0, 0.0, 20.0, 0.0])
    assert along["contact_force"].sel(body="mass", axis="x").values == pytest.approx([0.0, 0.0, -20.0, 0.0])
    assert along["contact_force"].sel(body="wall", axis="x").values == pytest.approx([0.0, 0.0, 20.0, 0.0])


def test_the_largest_deformation_is_remembered(against_wall, laws):
    model = against_wall("crush_plateau", {**CRUSH, "clearance": 0.0})
    position = -1.0 + np.array([0.0, 0.3, 0.28, 0.2, 0.28, 0.3])
    motion = xr.Dataset(
        {
            "position": (("time", "body", "axis"), np.stack([np.zeros(6), position], axis=1)[:, :, None]),
            "velocity": (("time", "body", "axis"), np.zeros((6, 2, 1))),
        },
        coords={"time": np.arange(6.0), "body": ["wall", "mass"], "axis": ["x"]},
    )
    force = forces_along(model, laws, motion)["force"].sel(joint="spring").values
    assert force == pytest.approx([0.0, 0.24, 0.12, 0.0, 0.12, 0.24])


def test_a_model_without_joints_has_no_forces(laws, against_wall):
    model = evolve(against_wall("linear_stop", {"stiffness": 1.0, "stop_deformation": 0.0}), joints=())
    motion = xr.Dataset(
        {name: (("time", "body", "axis"), np.zeros((3, 2, 1))) for name in ("position", "velocity")},
        coords={"time": [0.0, 1.0, 2.0], "body": ["wall", "mass"], "axis": ["x"]},
    )
    along = forces_along(model, laws, motion)
    assert along["force"].shape == (3, 0)
    assert not along["contact_force"].any()
