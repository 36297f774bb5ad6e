"""What a run takes and gives, and what it refuses."""

from typing import ClassVar

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.errors import CrashkitError, SimulationError
from crashkit.mechanics import Simulator, compile_engine, functions_of, simulate
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.testing import toys

TIMES = np.linspace(0.0, 3.0, 31)


@pytest.fixture
def model(against_wall, plateau):
    return against_wall("crush_plateau", plateau)


def test_a_motion_has_the_variables_and_units_of_the_data_contract(simulator, model):
    motion = simulator(model).run(TIMES, sensitivities=["body.mass.mass"])
    assert {name: (values.dims, values.attrs["units"]) for name, values in motion.items()} == {
        "position": (("time", "body", "axis"), "m"),
        "velocity": (("time", "body", "axis"), "m s-1"),
        "acceleration": (("time", "body", "axis"), "m s-2"),
        "contact_force": (("time", "body", "axis"), "N"),
        "deformation": (("time", "joint"), "m"),
        "deformation_rate": (("time", "joint"), "m s-1"),
        "force": (("time", "joint"), "N"),
        "position_sensitivity": (("time", "body", "axis", "parameter"), "m"),
        "velocity_sensitivity": (("time", "body", "axis", "parameter"), "m s-1"),
        "acceleration_sensitivity": (("time", "body", "axis", "parameter"), "m s-2"),
        "contact_force_sensitivity": (("time", "body", "axis", "parameter"), "N"),
        "force_sensitivity": (("time", "joint", "parameter"), "N"),
        "deformation_sensitivity": (("time", "joint", "parameter"), "m"),
        "deformation_rate_sensitivity": (("time", "joint", "parameter"), "m s-1"),
    }
    assert motion["body"].values.tolist() == ["wall", "mass"]
    assert motion["parameter"].values.tolist() == ["body.mass.mass"]
    assert motion["joint_bodies"].values.tolist() == [["wall", "mass"]]
    assert motion["time"].attrs["units"] == "s"


def test_a_motion_can_be_written_and_selected(simulator, model, tmp_path):
    motion = simulator(model).run(TIMES, sensitivities=["body.mass.mass"])
    motion.to_netcdf(tmp_path / "motion.nc")
    with xr.open_dataset(tmp_path / "motion.nc") as read:
        xr.testing.assert_equal(read, motion)
    assert motion.sel(time=1.0, body="mass", axis="x", method=None)["position"].dims == ()


def test_sensitivities_leave_the_motion_as_it_is(simulator, model):
    plain, other = (simulator(model).run(TIMES, sensitivities=paths) for paths in ([], ["joint.spring.crush_force"]))
    assert plain.identical(other.drop_dims("parameter"))


def test_the_wall_feels_what_the_mass_feels(simulator, model):
    motion = simulator(model).run(TIMES)
    wall, mass = (motion["contact_force"].sel(body=name).values for name in ("wall", "mass"))
    np.testing.assert_array_equal(wall, -mass)
    np.testing.assert_array_equal(motion["acceleration"].sel(body="mass").values, mass)


def test_values_override_the_model(simulator, model):
    changes = {"body.mass.mass": 2.0, "joint.spring.crush_force": 0.3}
    found, expected = simulator(model).run(TIMES, changes), simulator(model.with_values(changes)).run(TIMES)
    assert found.identical(expected)


def test_initial_values_are_paths_too(simulator, model):
    found = simulator(model).run(TIMES, {"body.mass.velocity": 1.3, "body.mass.position": -2.0})
    moved = evolve(model, bodies=(model.bodies[0], evolve(model.bodies[1], velocity=(1.3,), position=(-2.0,))))
    assert found.identical(simulator(moved).run(TIMES))


def test_values_of_instruments_are_not_the_engines_business(simulator, model):
    assert simulator(model).run(TIMES, {"instrument.film..clock_offset": 1e-3}).identical(simulator(model).run(TIMES))


def test_the_first_time_may_be_late(simulator, model):
    late, whole = simulator(model).run([2.0]), simulator(model).run([1.0, 2.0])
    np.testing.assert_allclose(late["position"].values[0], whole["position"].values[1], atol=1e-11)


def test_points_of_attachment_shift_the_contact(simulator, model):
    shifted = evolve(model, joints=(evolve(model.joints[0], points=((-0.1,), (0.2,)), free_length=Parameter(0.7)),))
    assert simulator(shifted).run(TIMES)["force"].values == pytest.approx(simulator(model).run(TIMES)["force"].values)


def test_a_model_without_joints_flies_straight(laws):
    body = Body("stone", (0.0,), (2.0,), Parameter(1.0))
    motion = simulate(Model("free", ("x",), (body,), ()), TIMES, laws)
    np.testing.assert_allclose(motion["position"].values[:, 0, 0], 2.0 * TIMES, atol=1e-14)


def test_bodies_at_rest_stay_at_rest(simulator, against_wall, plateau):
    motion = simulator(against_wall("crush_plateau", plateau, speed=0.0)).run(TIMES)
    assert np.ptp(motion["position"].values, axis=0).max() == 0.0


def test_a_mass_that_only_touches_turns_round(simulator, against_wall, plateau):
    """Grazing: thrown back by one spring just as far as the other begins."""
    model = against_wall("linear_stop", {"stiffness": 1.0, "stop_deformation": 1.0}, speed=1e-9, free_length=Parameter(2.0))
    motion = simulator(model).run(TIMES, step=1e-3)
    assert motion["deformation"].values[0, 0] == 1.0
    np.testing.assert_allclose(motion["deformation"].values[:, 0], 1.0 + 1e-9 * np.sin(TIMES), atol=1e-13)


def test_many_joints_that_meet_at_once(simulator, against_wall, joint, plateau):
    model = against_wall("crush_plateau", plateau)
    four = [joint(f"spring {i}", ("wall", "mass"), "crush_plateau", plateau | {"unloading_stiffness": 6.0}) for i in range(4)]
    one = joint(
        "one",
        ("wall", "mass"),
        "crush_plateau",
        {
            **{name: 4.0 * value for name, value in plateau.items()},
            "densification_deformation": 0.6,
            "unloading_stiffness": 24.0,
        },
    )
    found, expected = (simulator(evolve(model, joints=tuple(joints))).run(TIMES, step=1e-3) for joints in (four, [one]))
    np.testing.assert_allclose(found["position"].values, expected["position"].values, atol=1e-11)


# ---- refusals ----


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([], r"at least one, in one dimension, found an array of shape \(0,\)"),
        ([[0.0, 1.0]], r"at least one, in one dimension, found an array of shape \(1, 2\)"),
        ([0.0, np.nan], "finite numbers, found nan at index 1"),
        ([0.0, 2.0, 1.0], "strictly increasing numbers, found 1.0 after 2.0 at index 2"),
        ([-1.0, 0.0], "times from 0 on, found -1.0 at index 0"),
        (["late"], "numbers, found list that is none: could not convert string to float: 'late'"),
    ],
)
def test_times_that_cannot_be_used(simulator, model, times, message):
    with pytest.raises(CrashkitError, match=f"^times: expected {message}$"):
        simulator(model).run(times)


@pytest.mark.parametrize("step", [-1.0, 0.0, np.nan, np.inf, "short"])
def test_a_step_with_which_no_run_would_end(simulator, model, step):
    found = '"short"' if step == "short" else step
    weights = xr.Dataset({"position": (("time", "body", "axis"), np.zeros((31, 2, 1)))})
    for ask in (
        lambda: simulator(model).run(TIMES, step=step),
        lambda: simulator(model).adjoint(TIMES, weights, step=step),
    ):
        with pytest.raises(CrashkitError, match=f"^step: expected a positive number of seconds, found {found}$"):
            ask()


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("body.mass.mass", -10.0, "expected a value above 0, found -10.0"),
        ("body.mass.mass", np.nan, "expected a finite number, found nan"),
        ("body.mass.velocity", np.inf, "expected a finite number, found inf"),
        ("body.mass.position", "far", 'expected a number, found "far"'),
        ("joint.spring.crush_force", 2.0, "expected a value from 0.1 to 1.0, found 2.0"),
        ("joint.spring.toe", -1.0, "expected a value of at least 0.0, found -1.0"),
    ],
)
def test_values_that_a_file_could_not_hold(simulator, against_wall, plateau, path, value, message):
    """Of what the model leaves to its law, here the toe, the bounds are the law's."""
    model = against_wall("crush_plateau", plateau | {"crush_force": Parameter(0.24, 0.1, 1.0)})
    weights = xr.Dataset({"position": (("time", "body", "axis"), np.zeros((31, 2, 1)))})
    for ask in (
        lambda: simulator(model).run(TIMES, {path: value}),
        lambda: simulator(model).adjoint(TIMES, weights, {path: value}),
    ):
        with pytest.raises(CrashkitError, match=f"^model against the wall: {path}: {message}$"):
            ask()


def test_absent_physics_may_lie_outside_the_bounds(simulator, against_wall, plateau):
    model = against_wall("crush_plateau", plateau | {"unloading_stiffness": Parameter(6.0, 1.0, 10.0)})
    found = simulator(model).run(TIMES, {"joint.spring.unloading_stiffness": 0.0})
    assert found.identical(simulator(against_wall("crush_plateau", plateau)).run(TIMES))


def test_a_search_may_leave_the_bounds(simulator, against_wall, plateau):
    model = against_wall("crush_plateau", plateau | {"crush_force": Parameter(0.24, 0.1, 1.0)})
    motion = simulator(model).motion(TIMES, {"joint.spring.crush_force": 2.0})
    assert float(motion["force"].max()) > 1.0


@pytest.mark.parametrize(
    ("path", "hint"),
    [
        ("joint.spring.crush_froce", r' \(did you mean "joint.spring.crush_force"\?\)'),
        ("body.nobody.mass", r' \(did you mean "body.wall.mass"\?\)'),
        ("mass", ""),
        ("instrument.a.b.c", ""),
    ],
)
def test_a_path_that_the_model_does_not_have(simulator, model, path, hint):
    message = f'^expected a parameter of the model, found "{path}"{hint}$'
    with pytest.raises(CrashkitError, match=message):
        simulator(model).run(TIMES, sensitivities=[path])
    if not path.startswith("instrument."):
        with pytest.raises(CrashkitError, match=message):
            simulator(model).run(TIMES, {path: 1.0})


def test_without_laws_those_that_are_installed_are_used(laws, model):
    assert simulate(model, TIMES).identical(simulate(model, TIMES, laws))


def test_python_shows_its_model(simulator, model):
    assert repr(simulator(model)).splitlines()[0] == 'Simulator of model "against the wall" in x: 2 bodies, 1 joint'


def test_a_law_that_is_not_installed(laws, model):
    wrong = evolve(model, joints=(evolve(model.joints[0], law="origami"),))
    with pytest.raises(
        CrashkitError, match=r'^joint spring: expected one of the installed laws \(.*"viscous".*\), found "origami"$'
    ):
        Simulator(wrong, laws)


def test_a_factor_that_is_a_law(laws, model):
    wrong = evolve(model, joints=(evolve(model.joints[0], factors=("coulomb",)),))
    with pytest.raises(CrashkitError, match="joint spring: expected a function with unit 1, found coulomb with N"):
        Simulator(wrong, laws)


def test_a_parameter_without_a_value(laws, against_wall):
    with pytest.raises(CrashkitError, match="joint spring: expected a number for crush_force, found nothing"):
        Simulator(against_wall("crush_plateau", {"elastic_stiffness": 1.0}), laws)


def test_a_plane_model_without_inertia(laws, model):
    with pytest.raises(CrashkitError, match="body mass: expected one number for inertia, found 0"):
        Simulator(evolve(model, axes=("x", "y")), laws)


def test_an_engine_for_another_number_of_axes(laws, model):
    with pytest.raises(CrashkitError, match="model against the wall: expected an engine for 1 axes, found one for 2"):
        Simulator(model, laws, compile_engine(functions_of(model, laws), axes=2))


def test_an_engine_for_other_laws(laws, model):
    with pytest.raises(CrashkitError, match=r"expected an engine that holds its functions, found none for crush_plateau \(\)"):
        Simulator(model, laws, compile_engine([]))


class Jump(SpringLaw):
    """Not continuous: dry friction that jumps with the direction of the rate, and so holds the mass at rest."""

    name = "jump"
    passive = False
    parameters: ClassVar = (ParameterSpec("push", "N", "either way"),)

    @staticmethod
    def force(d, ddot, d_max, push):
        return push if ddot > 0.0 else -push


class Pole(SpringLaw):
    """Not finite where it is pressed hard."""

    name = "pole"
    parameters: ClassVar = (ParameterSpec("scale", "N", "of the force"),)

    @staticmethod
    def force(d, ddot, d_max, scale):
        return scale * (1.0 - d) ** -0.5 - scale


@pytest.fixture(scope="module")
def strange():
    strange = {"jump": Jump, "pole": Pole}
    return strange, compile_engine([function for name in strange for function in _functions(name, strange)])


def _functions(name, laws):
    parameter = {"jump": "push", "pole": "scale"}[name]
    joint = Joint("spring", ("wall", "mass"), name, {parameter: Parameter(1.0)})
    return functions_of(Model("one", ("x",), (), (joint,)), laws)


def test_a_law_that_holds_its_joint_on_a_jump(strange, against_wall):
    laws, engine = strange
    with pytest.raises(
        SimulationError, match="no progress past the branches of joint spring between wall and mass at t = 0.02"
    ):
        Simulator(against_wall("jump", {"push": 50.0}), laws, engine).run(TIMES, step=1e-3)


def test_a_force_that_is_not_finite(strange, against_wall):
    laws, engine = strange
    with pytest.raises(SimulationError, match="the force of joint spring between wall and mass at t = .* s is not finite"):
        Simulator(against_wall("pole", {"scale": 1e-3}), laws, engine).run(TIMES, step=1e-3)


def test_a_force_that_has_no_value_beyond_its_end_is_left_where_places_are_rounded(laws):
    """A hook whose pull is a power of how far it is stretched, between bodies metres from the origin."""
    random, toy = np.random.default_rng(0), toys.two_degrees()
    for _ in range(30):
        play, force, exponent, speed = random.uniform((1e-3, 5e3, 1.0, 0.5), (0.02, 5e4, 3.0, 1.3))
        numbers = {"play": Parameter(play), "pull_force": Parameter(force), "pull_exponent": Parameter(exponent)}
        hooked = evolve(toy, joints=(*toy.joints, Joint("hook", toy.joints[1].bodies, "hook", numbers)))
        motion = Simulator(hooked, laws).run(np.arange(601) * 5e-4, initial=toys.initial_state(hooked, speed), step=5e-4)
        deformation, pull = motion["deformation"].sel(joint="hook").values, motion["force"].sel(joint="hook").values
        stretched = np.maximum.accumulate(np.maximum(deformation, 0.0)) - deformation - play
        assert (pull <= 0.0).all() and (pull[stretched < 0.0] == 0.0).all()
