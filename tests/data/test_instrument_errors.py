"""Error parameters by channel, and places in a motion."""

import numpy as np
import pytest
import xarray as xr

from crashkit.data.instrument_errors import error_values, positions, prediction_coordinates
from crashkit.data.schema import GroupSchema
from crashkit.errors import CrashkitError
from crashkit.protocols import Observer, ParameterSpec


class Thermometer(Observer):
    """A third party's instrument with two probes."""

    name = "thermometer"
    schema = GroupSchema("thermometer", ())
    quantity = "temperature"
    channel = "probe"
    errors = (
        ParameterSpec("gain", "1", "recorded per true", null=1.0),
        ParameterSpec("bias", "K", "offset", null=0.0),
        ParameterSpec("clock_offset", "s", "delay", null=0.0),
    )
    instrument_errors = ("clock_offset",)

    def predict(self, motion: xr.Dataset, instrument: xr.Dataset, errors: object = None) -> xr.Dataset:
        raise NotImplementedError

    def reconstruct(self, instrument: xr.Dataset) -> xr.Dataset:
        raise NotImplementedError


PROBES, AXES = ["front", "rear"], ["x", "y"]


def values(errors: dict | None) -> dict[str, list]:
    return {name: array.tolist() for name, array in error_values(Thermometer(), PROBES, AXES, errors).items()}


def test_without_errors_every_channel_has_the_null() -> None:
    assert values(None) == {"gain": [[1, 1], [1, 1]], "bias": [[0, 0], [0, 0]], "clock_offset": [[0, 0], [0, 0]]}


def test_what_is_named_more_closely_wins() -> None:
    errors = {"rear/y": {"gain": 4.0}, "rear": {"gain": 3.0}, "": {"gain": 2.0, "clock_offset": 0.1}}
    assert values(errors)["gain"] == [[2, 2], [3, 4]]
    assert values(dict(reversed(errors.items())))["gain"] == [[2, 2], [3, 4]]
    assert values(errors)["clock_offset"] == [[0.1, 0.1], [0.1, 0.1]]


def test_a_channel_that_a_run_lacks_is_passed_over() -> None:
    assert values({"side": {"gain": 2.0}, "side/x": {"bias": 1.0}}) == values(None)


@pytest.mark.parametrize(
    ("errors", "message"),
    [
        ({"front": {"drift": 1.0}}, r"thermometer 'front': expected an error of \['bias', 'gain'\], found 'drift'"),
        (
            {"front": {"clock_offset": 1.0}},
            r"thermometer 'front': expected an error of \['bias', 'gain'\], found 'clock_offset'",
        ),
        ({"": {"drift": 1.0}}, r"thermometer '': expected an error of \['bias', 'clock_offset', 'gain'\], found 'drift'"),
    ],
)
def test_an_error_that_is_not_declared_there_is_refused(errors, message) -> None:
    with pytest.raises(CrashkitError, match=message):
        values(errors)


@pytest.fixture
def motion() -> xr.Dataset:
    return xr.Dataset(coords={"body": ["car", "engine", "wall"], "axis": AXES, "parameter": ["a", "b"]})


def test_positions_are_those_in_the_motion(motion) -> None:
    np.testing.assert_array_equal(positions(Thermometer(), motion, "body", ["wall", "car", "wall"]), [2, 0, 2])


def test_a_body_that_the_motion_lacks_is_named(motion) -> None:
    with pytest.raises(CrashkitError, match=r"thermometer: expected a body of the motion \(car, engine, wall\), found pole"):
        positions(Thermometer(), motion, "body", ["car", "pole"])


def test_a_prediction_has_the_coordinates_of_its_instrument_and_the_names_of_errors(motion) -> None:
    dims = ("time", "probe", "axis")
    instrument = xr.Dataset(
        {"temperature": (dims, np.zeros((3, 2, 2)))}, {"time": [0.0, 1.0, 2.0], "probe": PROBES, "axis": AXES}
    )
    coordinates = prediction_coordinates(Thermometer(), motion, instrument)
    assert set(coordinates) == {*dims, "error", "parameter"}
    assert coordinates["error"].values.tolist() == ["gain", "bias", "clock_offset"]
    assert coordinates["probe"].values.tolist() == PROBES
