from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from crashkit.data.channel_filter import filter_channel
from crashkit.data.validate import faults_of
from crashkit.errors import CrashkitError
from crashkit.testing.observer_contract import ObserverContract
from crashkit_accelerometers import Accelerometer, LoadCell

DIMS = ("time", "sensor", "axis")


def accelerometer_at(times: np.ndarray, cfc: int = 0) -> xr.Dataset:
    return xr.Dataset(
        {
            "acceleration": (DIMS, np.zeros((len(times), 2, 1)), {"units": "m s-2"}),
            "sensor_body": ("sensor", ["car", "engine"]),
            "sensor_point": (("sensor", "axis"), np.zeros((2, 1)), {"units": "m"}),
            "acceleration_std": ("sensor", [2.0, 3.0], {"units": "m s-2"}),
        },
        {"time": times, "sensor": ["car_acc", "engine_acc"], "axis": ["x"]},
        {"observer": "accelerometer", "channel_frequency_class": cfc, "frame": "laboratory"},
    )


def load_cell_at(times: np.ndarray, cfc: int = 0, bodies: tuple[str, ...] = ("wall",)) -> xr.Dataset:
    return xr.Dataset(
        {
            "force": (DIMS, np.zeros((len(times), len(bodies), 1)), {"units": "N"}),
            "sensor_body": ("sensor", list(bodies)),
            "force_std": ("sensor", np.full(len(bodies), 500.0), {"units": "N"}),
        },
        {"time": times, "sensor": [f"cell_{index}" for index in range(len(bodies))], "axis": ["x"]},
        {"observer": "load_cell", "channel_frequency_class": cfc},
    )


def motion_at(times: np.ndarray) -> xr.Dataset:
    """An engine (280 kg) and a car (1100 kg) in half-sine pulses; the wall receives their force."""
    dims = ("time", "body", "axis")
    engine, car = -300 * np.sin(40 * times), -200 * np.sin(25 * times)
    acceleration = np.stack([np.zeros_like(times), engine, car], axis=1)
    force = np.stack([-280 * engine - 1100 * car, 280 * engine, 1100 * car], axis=1)
    return xr.Dataset(
        {"acceleration": (dims, acceleration[..., None]), "contact_force": (dims, force[..., None])},
        {"time": times, "body": ["wall", "engine", "car"], "axis": ["x"]},
    )


@pytest.fixture
def motion() -> xr.Dataset:
    return motion_at(np.arange(1201) * 1e-4)


class TestAccelerometerContract(ObserverContract):
    @pytest.fixture
    def observer(self) -> Accelerometer:
        return Accelerometer()

    @pytest.fixture
    def instrument(self) -> xr.Dataset:
        return accelerometer_at(np.arange(1101) * 1e-4)


class TestFilteredAccelerometerContract(TestAccelerometerContract):
    round_trip = 0.02  # the filter takes the edge of the pulse

    @pytest.fixture
    def instrument(self) -> xr.Dataset:
        return accelerometer_at(np.arange(1101) * 1e-4, cfc=180)


class TestLoadCellContract(ObserverContract):
    @pytest.fixture
    def observer(self) -> LoadCell:
        return LoadCell()

    @pytest.fixture
    def instrument(self) -> xr.Dataset:
        return load_cell_at(np.arange(1101) * 1e-4)


class TestLoadCellInSpaceContract(ObserverContract):
    """The force on a wall along all axes of the laboratory."""

    @pytest.fixture
    def observer(self) -> LoadCell:
        return LoadCell()

    @pytest.fixture
    def motion(self) -> xr.Dataset:
        times = np.arange(1201) * 1e-4
        force = np.stack([9e4 * np.sin(25 * times), 2e4 * np.sin(60 * times), -5e3 * np.sin(90 * times)], axis=1)
        variables = {"contact_force": (("time", "body", "axis"), force[:, None])}
        return xr.Dataset(variables, {"time": times, "body": ["wall"], "axis": ["x", "y", "z"]})

    @pytest.fixture
    def instrument(self) -> xr.Dataset:
        times = np.arange(1101) * 1e-4
        variables = {"force": (DIMS, np.zeros((1101, 1, 3)), {"units": "N"}), "sensor_body": ("sensor", ["wall"])}
        coordinates = {"time": times, "sensor": ["cell"], "axis": ["x", "y", "z"]}
        return xr.Dataset(variables, coordinates, {"observer": "load_cell", "channel_frequency_class": 0})


def test_a_load_cell_picks_up_what_pushes_across(motion: xr.Dataset) -> None:
    times = np.array([0.01, 0.03])
    across = motion["contact_force"].assign_coords(axis=["y"]) * 0.5
    both = xr.concat([motion["contact_force"], across], "axis").to_dataset()
    found = LoadCell().predict(both, load_cell_at(times), {"cell_0": {"transverse_y": 0.02}})["force"]
    straight = LoadCell().predict(motion, load_cell_at(times))["force"]
    np.testing.assert_allclose(found, 1.01 * straight)


def test_each_sensor_shows_its_own_body(motion: xr.Dataset) -> None:
    times = np.array([0.01, 0.02, 0.05])
    predicted = Accelerometer().predict(motion, accelerometer_at(times))["acceleration"]
    expected = np.stack([-200 * np.sin(25 * times), -300 * np.sin(40 * times)], axis=1)
    np.testing.assert_allclose(predicted[:, :, 0], expected)
    assert predicted.attrs["units"] == "m s-2"


def test_between_nodes_the_interpolation_is_linear() -> None:
    predicted = Accelerometer().predict(motion_at(np.array([0.0, 0.02])), accelerometer_at(np.array([0.005, 0.01])))
    np.testing.assert_allclose(predicted["acceleration"][:, 0, 0], np.array([0.25, 0.5]) * -200 * np.sin(0.5))


def test_before_contact_nothing_accelerates() -> None:
    motion = motion_at(np.linspace(0.0, 0.05, 501)) + 100.0
    predicted = Accelerometer().predict(motion, accelerometer_at(np.array([-0.02, -1e-9, 0.0])))["acceleration"]
    np.testing.assert_allclose(predicted[:, 0, 0], [0.0, 0.0, 100.0])


def test_a_wall_receives_the_force_that_the_vehicle_loses(motion: xr.Dataset) -> None:
    times = np.array([0.01, 0.03])
    predicted = LoadCell().predict(motion, load_cell_at(times))["force"].values[:, 0, 0]
    np.testing.assert_allclose(predicted, 280 * 300 * np.sin(40 * times) + 1100 * 200 * np.sin(25 * times))
    assert (predicted > 0).all()


@pytest.mark.parametrize("cfc", [60, 180, 600, 1000])
def test_a_filtered_channel_is_predicted_through_its_filter(motion: xr.Dataset, cfc: int) -> None:
    times = np.arange(1201) * 1e-4
    errors = {"car_acc": {"gain": 1.1, "bias": 3.0}, "": {"clock_offset": 0.004}}
    predicted = Accelerometer().predict(motion, accelerometer_at(times, cfc), errors)["acceleration"]
    sensed = 1.1 * np.interp(times - 0.004, times, -200 * np.sin(25 * times), left=0.0) + 3.0
    np.testing.assert_allclose(predicted[:, 0, 0], filter_channel(sensed, times, cfc, before=3.0), atol=1e-9)


def test_a_filtered_channel_that_starts_with_a_jump_was_at_rest_before() -> None:
    times = np.arange(-400, 801) * 1e-4
    motion = motion_at(times[400:]) + 100.0
    whole = Accelerometer().predict(motion, accelerometer_at(times, 180))["acceleration"].values
    from_contact = Accelerometer().predict(motion, accelerometer_at(times[400:], 180))["acceleration"].values
    np.testing.assert_allclose(from_contact, whole[400:], atol=1e-6)
    assert 40.0 < from_contact[0, 0, 0] < 60.0


def test_the_filter_stops_at_the_end_of_the_motion() -> None:
    times = np.arange(1201) * 1e-4
    motion = motion_at(times[:1001])
    predicted = Accelerometer().predict(motion, accelerometer_at(times, 180))["acceleration"].values
    alone = Accelerometer().predict(motion, accelerometer_at(times[:1001], 180))["acceleration"].values
    np.testing.assert_array_equal(predicted[:1001], alone)
    assert np.isnan(predicted[1001:]).all()


def test_of_a_motion_that_ends_before_the_first_sample_nothing_is_known(motion: xr.Dataset) -> None:
    predicted = Accelerometer().predict(motion.isel(time=slice(0, 10)), accelerometer_at(np.array([0.5, 0.6])))
    assert np.isnan(predicted["acceleration"]).all()


def test_sensors_on_one_body_are_averaged_and_gaps_are_kept() -> None:
    instrument = accelerometer_at(np.array([0.0, 0.01, 0.02]))
    instrument["sensor_body"] = ("sensor", ["car", "car"])
    instrument["acceleration"] = (DIMS, np.array([[1.0, 3.0], [2.0, np.nan], [-2.0, 4.0]])[..., None])
    reconstructed = Accelerometer().reconstruct(instrument)["acceleration"]
    assert reconstructed["body"].values.tolist() == ["car"]
    np.testing.assert_array_equal(reconstructed[:, 0, 0], [2.0, np.nan, 1.0])


@pytest.mark.parametrize("call", [lambda i, m: LoadCell().predict(m, i), lambda i, m: LoadCell().reconstruct(i)])
def test_cells_that_share_a_body_are_refused(motion: xr.Dataset, call: Callable[[xr.Dataset, xr.Dataset], object]) -> None:
    with pytest.raises(CrashkitError, match="load_cell: expected one sensor for each body, found several on wall: sum them"):
        call(load_cell_at(np.array([0.0, 0.01]), bodies=("wall", "wall")), motion)


def test_a_motion_without_the_quantity_is_refused(motion: xr.Dataset) -> None:
    with pytest.raises(CrashkitError, match="load_cell: expected a motion with contact_force, found none"):
        LoadCell().predict(motion.drop_vars("contact_force"), load_cell_at(np.array([0.0, 0.01])))


def test_a_body_that_the_motion_lacks_is_named(motion: xr.Dataset) -> None:
    with pytest.raises(CrashkitError, match=r"load_cell: expected a body of the motion \(wall, engine, car\), found pole"):
        LoadCell().predict(motion, load_cell_at(np.array([0.0, 0.01]), bodies=("pole",)))


@pytest.mark.parametrize("errors", [{"car_acc": {"clock_offset": 1e-3}}, {"": {"drift": 1.0}}])
def test_an_error_that_is_not_declared_there_is_refused(motion: xr.Dataset, errors: dict) -> None:
    with pytest.raises(CrashkitError, match="expected an error of"):
        Accelerometer().predict(motion, accelerometer_at(np.array([0.0, 0.01])), errors)


@pytest.mark.parametrize("ground", [100.0, -100.0])
def test_a_load_cell_does_not_feel_what_holds_its_body_from_behind(ground: float) -> None:
    """The car pushes the wall with 100 N; the ground takes 40 N of that, wherever its centre is; the rest moves the wall."""
    places, joints = {"ground": ground, "wall": 0.0, "car": -1.0}, [["wall", "car"], ["ground", "wall"]]
    net = np.array([40.0, 60.0, -100.0])
    motion = xr.Dataset(
        {
            "position": (("time", "body", "axis"), np.tile(np.array([*places.values()])[:, None], (2, 1, 1))),
            "contact_force": (("time", "body", "axis"), np.tile(net[:, None], (2, 1, 1))),
            "force": (("time", "joint"), np.tile([100.0, 40.0], (2, 1))),
            "joint_bodies": (("joint", "end"), joints),
            "joint_side": ("joint", [-1.0, -1.0]),
            "joint_support": ("joint", [False, True]),
        },
        {"time": [0.0, 0.01], "body": list(places), "axis": ["x"]},
    )
    felt = LoadCell().predict(motion, load_cell_at(np.array([0.0, 0.01])))["force"]
    assert felt.values.ravel().tolist() == [100.0, 100.0]
    with pytest.raises(
        CrashkitError, match="load_cell: expected a motion with joint_side, as some joint supports a body, found none"
    ):
        LoadCell().predict(motion.drop_vars("joint_side"), load_cell_at(np.array([0.0, 0.01])))


@pytest.mark.parametrize("std", [-1.0, 0.0])
def test_a_standard_deviation_that_is_not_above_0_is_refused(std: float) -> None:
    times = np.arange(11) * 1e-3
    given = {"acceleration_std": (Accelerometer(), accelerometer_at(times)), "force_std": (LoadCell(), load_cell_at(times))}
    for name, (observer, group) in given.items():
        group["time"].attrs["units"] = "s"
        assert faults_of(group, observer.schema) == []
        group[name][0] = std
        first = str(group["sensor"].values[0])
        assert [str(fault) for fault in faults_of(group, observer.schema)] == [
            f"{observer.name}/{name}: expected values above 0, found 1 of {group[name].size} values not above 0, "
            f'the first at sensor "{first}"'
        ]
