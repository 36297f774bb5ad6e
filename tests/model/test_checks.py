import pytest
import xarray as xr
from attrs import evolve

from crashkit.errors import ContractError
from crashkit.model import Body, GivenMotion, Joint, Model, Parameter
from crashkit.model.checks import check_model, check_recording_against_model, model_faults


@pytest.fixture
def model() -> Model:
    return Model(
        "sled",
        ("x",),
        (
            Body("barrier", (0.0,), (0.0,), fixed=True),
            Body("engine", (-0.5,), (10.0,), Parameter(280.0)),
            Body("body", (-1.5,), (10.0,), Parameter(900.0, fixed=True)),
        ),
        (Joint("front", ("barrier", "engine"), "linear", {"stiffness": Parameter(1e6)}),),
    )


def recording(bodies: list[str], initial: list[str], axis: str = "x") -> xr.DataTree:
    return xr.DataTree.from_dict(
        {
            "initial": xr.Dataset(coords={"body": initial, "axis": [axis]}),
            "acc": xr.Dataset({"sensor_body": ("sensor", bodies)}, attrs={"observer": "accelerometer"}),
            "notes": xr.Dataset({"driver_body": ("driver", ["nobody"])}),
        }
    )


def test_a_free_mass_must_not_fall_below_zero(model, laws):
    with pytest.raises(ContractError, match=r'^sled: body "engine"/mass: expected a lower bound of at least 0, found -inf$'):
        check_model(model, laws, "sled")


def test_a_name_that_two_bodies_bear_is_told_once(model, laws):
    twice = evolve(model, bodies=(*model.bodies[:2], evolve(model.bodies[2], name="engine", carrier="door")))
    joined = evolve(twice, joints=(evolve(model.joints[0], bodies=("barrier", "body")),))
    assert [str(fault) for fault in model_faults(joined, laws) if "lower bound" not in str(fault)][:3] == [
        'body: expected names without repeats, found "engine" 2 times',
        'body "engine"/carrier: expected one of "barrier", found "door"',
        'joint "front"/bodies: expected one of "barrier", "engine", found "body"',
    ]


def test_a_program_may_leave_out_what_has_a_default(model, laws):
    check_model(model.with_parameters({"body.engine.mass": Parameter(280.0, 1.0, 400.0)}), laws, "sled")


def test_the_recording_of_this_model(model):
    check_recording_against_model(recording(["engine", "barrier"], ["engine", "body"]), model, "run.nc")


def test_a_sensor_on_a_body_that_is_not_there(model):
    message = (
        r'^run.nc: acc/sensor_body: expected bodies of the model \("barrier", "engine", "body"\), found "engin", "wheel"$'
    )
    with pytest.raises(ContractError, match=message):
        check_recording_against_model(recording(["engin", "engine", "wheel"], ["engine"]), model, "run.nc")


def test_the_initial_state_of_a_misspelt_body(model):
    with pytest.raises(ContractError, match=r'^run.nc: initial/body: expected the model\'s "engine", found "engin"$'):
        check_recording_against_model(recording(["engine"], ["engin", "body"]), model, "run.nc")


def test_the_initial_state_of_more_bodies_or_fewer_is_no_fault(model):
    check_recording_against_model(recording(["engine"], ["engine", "body", "cargo"]), model, "run.nc")
    check_recording_against_model(recording(["engine"], ["engine"]), model, "run.nc")


def test_an_initial_state_along_another_axis(model):
    with pytest.raises(ContractError, match=r'^run.nc: initial/axis: expected the model\'s "x", found "y"$'):
        check_recording_against_model(recording(["engine"], ["engine"], axis="y"), model, "run.nc")


@pytest.fixture
def plane() -> Model:
    car = Body("car", (-2.0, 0.0), (10.0, 0.0), Parameter(1000.0), inertia=(Parameter(1500.0),))
    sled = Body("sled", (5.0, 0.0), (0.0, 0.0), motion=GivenMotion((0.0, 1.0), ((5.0, 0.0), (6.0, 0.0))))
    return Model("car", ("x", "y"), (car, sled), ())


def initial(axes: str, quaternion: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)) -> xr.DataTree:
    turning = {
        "orientation": (("body", "quaternion"), [quaternion]),
        "angular_velocity": (("body", "axis"), [[0.0] * len(axes)]),
    }
    return xr.DataTree.from_dict({"initial": xr.Dataset(turning, {"body": ["car"], "axis": list(axes)})})


def test_a_recording_in_the_plane_may_hold_how_bodies_turn(plane):
    check_recording_against_model(initial("xyz"), plane, "run.nc")


def test_a_plane_turns_about_the_axis_across_it(plane):
    message = r'^run.nc: initial/angular_velocity: expected the model\'s "z", found "x", "y"$'
    with pytest.raises(ContractError, match=message):
        check_recording_against_model(initial("xy"), plane, "run.nc")


def test_an_initial_state_without_an_axis_of_the_plane(plane):
    with pytest.raises(ContractError, match=r'^run.nc: initial/axis: expected the model\'s "y", found "x", "z"$'):
        check_recording_against_model(initial("xz"), plane, "run.nc")


def test_an_initial_orientation_that_is_no_unit_quaternion(plane):
    message = r'^run.nc: initial/orientation: expected quaternions of length 1, found one of length 1.5 at body "car"$'
    with pytest.raises(ContractError, match=message):
        check_recording_against_model(initial("xyz", (0.0, 0.0, 0.0, 1.5)), plane, "run.nc")


def test_one_axis_knows_nothing_of_turning(model):
    tree = initial("x", (0.0, 0.0, 0.0, 1.5))
    tree["initial"] = xr.DataTree(tree["initial"].to_dataset().assign_coords(body=["engine"]))
    check_recording_against_model(tree, model, "run.nc")
