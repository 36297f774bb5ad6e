import numpy as np
import pytest
import xarray as xr
from attrs import fields
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from crashkit.data.netcdf import read_tree, write_tree
from crashkit.errors import ContractError
from crashkit.model import Body, GivenForce, GivenMotion, InstrumentErrors, Joint, Model, Parameter
from crashkit.model.dataset import MODEL, model_from_dataset, model_to_dataset
from crashkit.testing.strategies import models


@pytest.fixture
def model() -> Model:
    return Model(
        "sled",
        ("x",),
        (
            Body("barrier", (0.0,), (0.0,), fixed=True),
            Body("engine", (-0.5,), (10.0,), Parameter(280.0, fixed=True), carrier="barrier"),
        ),
        (
            Joint(
                "front",
                ("barrier", "engine"),
                "curve",
                {"force": (Parameter(1e5, 0.0, 2e5), Parameter(2e5)), "exponent": Parameter(0.3)},
                factors=("power",),
                points=((0.0,), (0.1,)),
                free_length=Parameter(0.4),
            ),
            Joint("rear", ("barrier", "engine"), "linear", {}),
        ),
        (InstrumentErrors("film", "", {"clock_offset": Parameter(0.0)}), InstrumentErrors("acc", "a.1", {})),
    )


@pytest.fixture
def plane() -> Model:
    motion = GivenMotion((0.0, 0.1), ((-2.0, 0.0), (-1.0, 0.1)), ((0.0,), (0.2,)))
    force = GivenForce((0.0, 0.05, 0.1), ((0.0, 0.0), (10.0, 0.0), (0.0, 0.0)), ((0.0,), (3.0,), (0.0,)))
    return Model(
        "drop",
        ("x", "y"),
        (
            Body("barrier", (0.0, 0.0), (0.0, 0.0), fixed=True, orientation=(0.5,)),
            Body("pusher", (-2.0, 0.0), (0.0, 0.0), motion=motion),
            Body("lift", (2.0, 0.0), (0.0, 0.0), motion=GivenMotion((0.0, 1.0), ((2.0, 0.0), (2.0, 1.0)))),
            Body(
                "box",
                (-0.5, 0.0),
                (10.0, 0.0),
                Parameter(280.0),
                inertia=(Parameter(90.0, 0.0, 100.0),),
                angular_velocity=(0.1,),
                force=force,
            ),
            Body("load", (-0.5, 1.0), (10.0, 0.0), Parameter(30.0), inertia=(Parameter(2.0),)),
        ),
        (
            Joint("face", ("barrier", "box"), "linear", {}, normal=(-1.0, 0.0)),
            Joint("line", ("box", "load"), "linear", {}, support=True, acts_on=("barrier", "box"), driver="face"),
        ),
        gravity=(0.0, -9.81),
    )


def test_is_a_table_of_parameters_and_the_structure(model):
    dataset = model_to_dataset(model)
    assert dataset["parameter"].values.tolist() == list(model.parameters())
    assert dataset["value"].values.tolist() == [280.0, 0.4, 1e5, 2e5, 0.3, 0.0]
    assert dataset["fixed"].values.tolist() == [1, 0, 0, 0, 0, 0]
    assert dataset["joint_bodies"].sel(joint="front").values.tolist() == ["barrier", "engine"]
    assert dataset["body_position"].attrs == {"units": "m"}
    assert dataset.attrs == {"crashkit_schema": "crashkit-model/1", "name": "sled"}


def test_the_examples_leave_no_field_at_its_default(model, plane):
    parts = [part for example in (model, plane) for part in (example, *example.bodies, *example.joints, *example.instruments)]
    for kind in {type(part) for part in parts}:
        for field in (one for one in fields(kind) if one.name != "sums"):  # of hypotheses, which no file holds
            assert any(getattr(part, field.name) != field.default for part in parts if type(part) is kind), field.name


@pytest.mark.parametrize("name", ["model", "plane"])
def test_and_back(name, request):
    model = request.getfixturevalue(name)
    assert model_from_dataset(model_to_dataset(model)) == model


def test_has_only_the_variables_that_the_model_needs(model, plane):
    optional = {variable.name for variable in MODEL.variables if not variable.required}
    assert not optional & set(model_to_dataset(model))
    assert optional < set(model_to_dataset(plane))


def test_moments_of_inertia_are_parameters_like_others(plane):
    dataset = model_to_dataset(plane)
    assert dataset["parameter"].values.tolist() == list(plane.parameters())
    assert dataset["upper"].sel(parameter="body.box.inertia").item() == 100.0


def test_samples_of_given_motions_name_their_body(plane):
    dataset = model_to_dataset(plane)
    assert dataset["motion_body"].values.tolist() == ["pusher", "pusher", "lift", "lift"]
    assert dataset["motion_orientation"].values.ravel().tolist()[:2] == [0.0, 0.2]
    assert np.isnan(dataset["motion_orientation"].values[2:]).all()


@pytest.mark.parametrize("name", ["model", "plane"])
def test_through_netcdf(tmp_path, name, request):
    model = request.getfixturevalue(name)
    dataset = model_to_dataset(model)
    write_tree(xr.DataTree(dataset), tmp_path / "model.nc")
    found = read_tree(tmp_path / "model.nc").to_dataset()
    assert found.identical(dataset)
    assert model_from_dataset(found) == model


@settings(deadline=None)
@given(st.data())
def test_any_model_and_back(laws, data):
    model = data.draw(models(laws))
    assert model_from_dataset(model_to_dataset(model)) == model


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_any_model_through_netcdf(tmp_path_factory, laws, data):
    model = data.draw(models(laws))
    path = tmp_path_factory.mktemp("model") / "model.nc"
    write_tree(xr.DataTree(model_to_dataset(model)), path)
    assert model_from_dataset(read_tree(path).to_dataset()) == model


def test_a_dataset_that_is_no_model(model):
    dataset = model_to_dataset(model).drop_vars("joint_law")
    dataset["value"][2] = np.nan
    message = (
        "^model.nc: model/joint_law: expected a variable with dims \\(joint\\), found none\n"
        "model.nc: model/value: expected no NaN, found 1 of 6 values NaN, "
        'the first at parameter "joint.front.force\\[0\\]"$'
    )
    with pytest.raises(ContractError, match=message):
        model_from_dataset(dataset, "model.nc")


def test_a_parameter_that_nothing_owns(model):
    dataset = model_to_dataset(model)
    dataset["owner_index"][1] = 7
    message = "^dataset: model/owner_index: expected a body, joint or instrument of the model, found joint 7$"
    with pytest.raises(ContractError, match=message):
        model_from_dataset(dataset)
