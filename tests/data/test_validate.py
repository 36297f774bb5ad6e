import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import FRAME, INITIAL, MOTION
from crashkit.data.validate import check, faults_of
from crashkit.errors import ContractError
from crashkit.testing.strategies import datasets, motions

CAMERA = GroupSchema(
    "camera",
    (Variable("image", ("time", "view", "marker|sensor", "image_axis"), "pixel", "", allow_nan=True),),
)


def lines(dataset: xr.Dataset, schema: GroupSchema, group: str | None = None) -> list[str]:
    return [str(fault) for fault in faults_of(dataset, schema, group)]


def with_values(dataset: xr.Dataset, name: str, values: object) -> xr.Dataset:
    old = dataset.variables[name]
    return dataset.assign({name: xr.Variable(old.dims, values, old.attrs)})


def with_coordinate(dataset: xr.Dataset, name: str, values: object) -> xr.Dataset:
    old = dataset.variables[name]
    return dataset.drop_indexes(name).assign_coords({name: (old.dims, values, old.attrs)})


class TestKept:
    def test_a_complete_group_has_no_fault(self, film, schemas):
        assert lines(film, schemas["film"]) == []

    def test_unknown_variables_and_attributes_are_no_fault(self, film, schemas):
        film = film.assign(temperature=("time", np.full(4, np.nan))).assign_attrs(laboratory="north")
        assert lines(film, schemas["film"]) == []

    def test_a_hidden_frame_is_no_fault(self, film, schemas):
        film.position[1, 0, 0] = np.nan
        assert lines(film, schemas["film"]) == []

    def test_optional_variables_and_attributes_may_be_absent(self, film, accelerometer, schemas):
        assert lines(film.drop_vars("position_std"), schemas["film"]) == []
        assert lines(accelerometer, schemas["accelerometer"]) == []

    def test_a_marker_that_one_of_two_views_never_sees_is_no_fault(self):
        image = np.zeros((3, 2, 1, 2))
        image[:, 1] = np.nan
        time = ("time", [0.0, 0.1, 0.2], {"units": "s"})
        camera = xr.Dataset({"image": (("time", "view", "marker", "image_axis"), image, {"units": "pixel"})})
        assert lines(camera.assign_coords(time=time, marker=["m1"]), CAMERA) == []

    def test_text_may_be_stored_as_objects(self, film, schemas):
        film = with_values(film, "marker_body", np.array(["engine", "body"], dtype=object))
        assert lines(film, schemas["film"]) == []

    @settings(deadline=None)
    @given(st.data())
    def test_whatever_keeps_a_schema_has_no_fault(self, schemas, data):
        schema = data.draw(st.sampled_from([*schemas.values(), INITIAL, MOTION]))
        assert lines(data.draw(datasets(schema)), schema) == []


class TestStructure:
    def test_missing_variable(self, film, schemas):
        assert lines(film.drop_vars("marker_body"), schemas["film"]) == [
            "film/marker_body: expected a variable with dims (marker), found none"
        ]

    def test_dims_out_of_order(self, film, schemas):
        film["position"] = film.position.transpose("marker", "time", "axis")
        assert lines(film, schemas["film"]) == [
            "film/position: expected dims (time, marker, axis), found (marker, time, axis)"
        ]

    def test_dim_too_many(self, film, schemas):
        film["position"] = film.position.expand_dims("view")
        assert lines(film, schemas["film"]) == [
            "film/position: expected dims (time, marker, axis), found (view, time, marker, axis)"
        ]

    def test_alternative_dims_are_named(self):
        camera = xr.Dataset({"image": ((), 0.0, {"units": "pixel"})})
        assert lines(camera, CAMERA) == ["camera/image: expected dims (time, view, marker or sensor, image_axis), found ()"]

    def test_places_name_the_group_where_it_is_given(self, film, schemas):
        film["position"].attrs["units"] = "mm"
        assert lines(film, schemas["film"], "left") == ['left/position: expected units "m", found "mm"']

    def test_missing_units(self, film, schemas):
        del film["position"].attrs["units"]
        del film["time"].attrs["units"]
        assert lines(film, schemas["film"]) == [
            'film/time: expected units "s", found none',
            'film/position: expected units "m", found none',
        ]

    def test_wrong_kind(self, film, schemas):
        film = with_values(film, "marker_body", [1, 2])
        film = with_values(film, "position_std", ["small", "large"])
        assert lines(film, schemas["film"]) == [
            "film/marker_body: expected text, found values of type int64",
            "film/position_std: expected numbers, found text",
        ]

    def test_a_group_that_may_hold_anything_must_hold_something(self):
        assert lines(xr.Dataset(), MOTION) == [
            "motion: expected at least one of position, velocity, acceleration, orientation, angular_velocity, "
            "angular_acceleration, contact_force, contact_moment, deformation, deformation_rate, force, found none"
        ]


class TestCoordinates:
    def test_missing_labels(self, film, schemas):
        assert lines(film.drop_vars("marker"), schemas["film"]) == [
            "film/marker: expected a coordinate (names of markers on a film), found none"
        ]

    def test_missing_time(self, film, schemas):
        assert lines(film.drop_vars("time"), schemas["film"]) == [
            "film/time: expected a coordinate (s, strictly increasing, need not be uniform), found none"
        ]

    def test_time_that_goes_back(self, film, schemas):
        film = with_coordinate(film, "time", [0.0, 0.001, 0.002, 0.0015])
        assert lines(film, schemas["film"]) == [
            "film/time: expected strictly increasing values, found 0.0015 after 0.002 at index 3"
        ]

    def test_time_that_stands_still(self, film, schemas):
        film = with_coordinate(film, "time", [0.0, 0.001, 0.001, 0.002])
        assert lines(film, schemas["film"]) == [
            "film/time: expected strictly increasing values, found 0.001 after 0.001 at index 2"
        ]

    def test_time_with_nan_and_infinity(self, film, schemas):
        film = with_coordinate(film, "time", [0.0, np.nan, np.nan, np.inf])
        assert lines(film, schemas["film"]) == [
            "film/time: expected finite values, found NaN at index 1 (2 in all)",
            "film/time: expected finite values, found infinite at index 3 (1 in all)",
        ]

    def test_time_as_dates(self, film, schemas):
        film = with_coordinate(film, "time", np.arange(4).astype("datetime64[ns]"))
        assert lines(film, schemas["film"]) == ["film/time: expected numbers, found values of type datetime64[ns]"]

    def test_no_time_at_all(self, film, schemas):
        assert lines(film.isel(time=slice(0)), schemas["film"]) == ["film/time: expected at least one value, found none"]

    def test_repeated_labels(self, film, schemas):
        assert lines(with_coordinate(film, "marker", ["m1", "m1"]), schemas["film"]) == [
            'film/marker: expected labels without repeats, found "m1" more than once'
        ]

    def test_empty_labels(self, film, schemas):
        assert lines(with_coordinate(film, "marker", ["m1", ""]), schemas["film"]) == [
            'film/marker: expected labels that are not empty, found "" at index 1'
        ]

    def test_numbers_as_labels(self, film, schemas):
        assert lines(with_coordinate(film, "marker", [1, 2]), schemas["film"]) == [
            "film/marker: expected text labels, found values of type int64"
        ]

    def test_an_axis_that_is_not_of_space(self, film, schemas):
        assert lines(with_coordinate(film, "axis", ["w"]), schemas["film"]) == [
            'film/axis: expected labels out of "x", "y", "z", found "w"'
        ]


class TestValues:
    def test_a_channel_without_values_is_named(self, film, schemas):
        film.position[:, 1] = np.nan
        assert lines(film, schemas["film"]) == [
            'film/position: expected a value in every channel, found only NaN at marker "m2", axis "x"'
        ]

    def test_a_channel_without_labels_is_counted(self, film, schemas):
        film.position[:, 1] = np.nan
        assert lines(film.drop_vars("marker"), schemas["film"])[-1] == (
            'film/position: expected a value in every channel, found only NaN at marker 1, axis "x"'
        )

    def test_nan_where_it_is_not_allowed(self, accelerometer, schemas):
        accelerometer.acceleration[1:, 0, 0] = np.nan
        assert lines(accelerometer, schemas["accelerometer"]) == [
            "accelerometer/acceleration: expected no NaN, found 2 of 3 values NaN, the first at time 0.0001 (index 1), "
            'sensor "engine_acc", axis "x"'
        ]

    def test_an_empty_channel_does_not_conceal_nan_in_another(self, accelerometer, schemas):
        accelerometer = xr.concat([accelerometer, accelerometer.assign_coords(sensor=["b"])], "sensor", data_vars="minimal")
        accelerometer.acceleration[:, 0] = np.nan
        accelerometer.acceleration[2, 1] = np.nan
        assert lines(accelerometer, schemas["accelerometer"]) == [
            'accelerometer/acceleration: expected a value in every channel, found only NaN at sensor "engine_acc", axis "x"',
            "accelerometer/acceleration: expected no NaN, found 1 of 6 values NaN, the first at time 0.0002 (index 2), "
            'sensor "b", axis "x"',
        ]

    def test_infinite_values(self, film, schemas):
        film.position[2, 1, 0] = -np.inf
        assert lines(film, schemas["film"]) == [
            "film/position: expected finite values, found 1 of 8 values infinite, the first at time 0.002 (index 2), "
            'marker "m2", axis "x"'
        ]

    def test_a_standard_deviation_of_zero(self, film, schemas):
        film = with_values(film, "position_std", [0.0, 0.001])
        assert lines(film, schemas["film"]) == [
            'film/position_std: expected values above 0, found 1 of 2 values not above 0, the first at marker "m1"'
        ]

    def test_a_scalar_has_no_place(self):
        schema = GroupSchema("rig", (Variable("mass", (), "kg", "of the sled"),))
        rig = xr.Dataset({"mass": ((), np.nan, {"units": "kg"})})
        assert lines(rig, schema) == ["rig/mass: expected no NaN, found 1 of 1 values NaN"]

    def test_a_flag_that_is_neither(self, film, schemas):
        film = film.assign(hidden=(("time", "marker"), [[0, 1], [0, 2], [0, 0], [1, 1]]))
        assert lines(film, schemas["film"]) == [
            'film/hidden: expected 0 or 1, found 1 of 8 values neither, the first at time 0.001 (index 1), marker "m2"'
        ]


class TestAttributes:
    def test_missing(self, accelerometer, schemas):
        del accelerometer.attrs["frame"]
        assert lines(accelerometer, schemas["accelerometer"]) == [
            'accelerometer: expected attribute frame one of "body", "laboratory", found none'
        ]

    def test_not_one_of_its_values(self, accelerometer, schemas):
        accelerometer.attrs.update(frame="car", channel_frequency_class=61)
        assert lines(accelerometer, schemas["accelerometer"]) == [
            "accelerometer: expected attribute channel_frequency_class one of 0, 60, 180, 600, 1000, found 61",
            'accelerometer: expected attribute frame one of "body", "laboratory", found "car"',
        ]

    @pytest.mark.parametrize("value", [np.int64(180), np.float32(180), 180.0])
    def test_any_numeric_type_will_do(self, accelerometer, schemas, value):
        accelerometer.attrs["channel_frequency_class"] = value
        assert lines(accelerometer, schemas["accelerometer"]) == []

    def test_a_list_is_not_one_of_its_values(self):
        schema = GroupSchema("rig", (), (FRAME,))
        rig = xr.Dataset(attrs={"frame": np.array([1, 2])})
        assert lines(rig, schema) == ['rig: expected attribute frame one of "body", "laboratory", found [1, 2]']


def test_every_fault_is_in_one_error(film, schemas):
    film = with_coordinate(film.drop_vars("marker_body"), "time", [0.0, 0.001, 0.0005, 0.002])
    film["position"].attrs["units"] = "mm"
    message = (
        "run_1.nc: film/marker_body: expected a variable with dims \\(marker\\), found none\n"
        "run_1.nc: film/time: expected strictly increasing values, found 0.0005 after 0.001 at index 2\n"
        'run_1.nc: film/position: expected units "m", found "mm"$'
    )
    with pytest.raises(ContractError, match=message):
        check(film, schemas["film"], "run_1.nc")


@settings(deadline=None)
@given(motions(), st.data())
def test_every_variable_in_turn_is_checked_for_units(motion, data):
    name = data.draw(st.sampled_from(sorted(motion.data_vars)))
    motion[name].attrs["units"] = "inch"
    units = {variable.name: variable.units for variable in MOTION.variables}[name]
    assert lines(motion, MOTION) == [f'motion/{name}: expected units "{units}", found "inch"']
