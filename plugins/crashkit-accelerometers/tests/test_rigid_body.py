"""From the readings of sensors on a rigid body back to its motion."""

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

from crashkit.errors import CrashkitError
from crashkit.testing.observer_contract import ObserverContract
from crashkit_accelerometers import Accelerometer, recorded, rigid_body_motion

TIMES = np.arange(1501) * 1e-4
SHORT = np.arange(201) * 7.5e-4
QUANTITIES = ("acceleration", "velocity", "position", "angular_velocity", "angular_acceleration")


def start_of(motion: xr.Dataset) -> xr.Dataset:
    return motion.isel(time=0, drop=True)[["position", "velocity", "angular_velocity", "orientation"]]


def perfect(motion: xr.Dataset, instrument: xr.Dataset) -> xr.Dataset:
    return recorded(Accelerometer(), motion, instrument.drop_vars("acceleration_std")).assign(
        acceleration_std=instrument["acceleration_std"]
    )


def turn_between(found: xr.Dataset, motion: xr.Dataset) -> np.ndarray:
    """The small rotation vector from the true orientation to the one found, rad, (time, 3)."""
    one, other = (Rotation.from_quat(it["orientation"].values[:, 0], scalar_first=True) for it in (found, motion))
    return (one * other.inv()).as_rotvec()


def test_three_perfect_triaxial_sensors_tell_everything(turning, sensors, three) -> None:
    motion = turning(TIMES)
    found = rigid_body_motion(perfect(motion, sensors(three, TIMES)), start_of(motion))
    assert np.degrees(np.abs(turn_between(found, motion))).max() < 1e-6
    for name in QUANTITIES:
        np.testing.assert_allclose(found[name], motion[name], atol=1e-9 * float(np.abs(motion[name]).max()))
    assert found.attrs["unknown"] == ""


def test_two_sensors_tell_everything_in_the_plane(plane, sensors) -> None:
    motion = plane(TIMES)
    instrument = sensors([[0.5, 0.1], [-0.6, 0.0]], TIMES, axes="xy")
    found = rigid_body_motion(perfect(motion, instrument), start_of(motion))
    assert np.degrees(np.abs(turn_between(found, motion))).max() < 1e-6
    for name in QUANTITIES:
        np.testing.assert_allclose(found[name], motion[name], atol=1e-9 * float(np.abs(motion[name]).max()))


def test_one_sensor_tells_everything_on_a_line(sensors) -> None:
    acceleration = -200 * np.sin(20 * TIMES)
    motion = xr.Dataset(
        {"acceleration": (("time", "body", "axis"), acceleration[:, None, None])},
        {"time": TIMES, "body": ["car"], "axis": ["x"]},
    )
    initial = xr.Dataset({"position": (("body", "axis"), [[-0.5]]), "velocity": (("body", "axis"), [[12.0]])}, motion.coords)
    found = rigid_body_motion(perfect(motion, sensors([[0.7]], TIMES, axes="x")), initial.drop_vars("time"))
    np.testing.assert_allclose(found["velocity"][:, 0, 0], 12 + 10 * (np.cos(20 * TIMES) - 1), atol=1e-8)
    expected = -0.5 + 12 * TIMES + 10 * (np.sin(20 * TIMES) / 20 - TIMES)
    np.testing.assert_allclose(found["position"][:, 0, 0], expected, atol=1e-9)
    assert "orientation" not in found


def test_a_start_that_turns_and_is_turned_is_taken_up(turning, sensors, three) -> None:
    """The second half of a motion, from the state in its middle; and from a state a little before the first sample."""
    motion = turning(TIMES)
    half = motion.isel(time=slice(700, None))
    found = rigid_body_motion(
        perfect(half, sensors(three, half["time"].values)).assign_coords(time=TIMES[:801]), start_of(half)
    )
    assert np.abs(turn_between(found, half)).max() < 1e-8
    np.testing.assert_allclose(found["position"], half["position"], atol=1e-7)


def test_before_contact_the_motion_is_uniform(turning, sensors, three) -> None:
    motion = turning(TIMES)
    early = np.arange(-200, 1301) * 1e-4
    found = rigid_body_motion(perfect(motion, sensors(three, early)), start_of(motion)).isel(time=slice(200, None))
    np.testing.assert_allclose(found["position"], motion["position"][:1301], atol=1e-9)


@pytest.mark.parametrize("cfc", [0, 180])
@pytest.mark.parametrize("axes", ["xyz", "xy", "x"])
def test_stated_uncertainty_is_what_happens(turning, plane, sensors, three, axes, cfc) -> None:
    motion = turning(SHORT) if axes == "xyz" else plane(SHORT)
    points = {"xyz": three, "xy": [[0.5, 0.1], [-0.3, 0.0]], "x": [[0.0]]}[axes]
    seen = motion if axes != "x" else motion[["acceleration", "velocity", "position"]].sel(axis=["x"])
    instrument = sensors(points, SHORT, axes=axes, std=2.0, cfc=cfc)
    base = perfect(seen, instrument.assign_attrs(channel_frequency_class=0))["acceleration"]
    start = start_of(motion).sel(axis=list(axes)) if axes != "xyz" else start_of(motion)
    ratios: dict[str, list[np.ndarray]] = {}
    for seed in range(24):
        noise = recorded(Accelerometer(), 0.0 * seen.drop_vars("orientation", errors="ignore"), instrument, seed=seed)
        found = rigid_body_motion(instrument.assign(acceleration=base + noise["acceleration"]), start)
        for name in QUANTITIES:
            if name in found:
                ratios.setdefault(name, []).append(_ratio(found[name] - seen[name], found[f"{name}_std"]))
        if "orientation" in found:
            turn = xr.DataArray(turn_between(found, motion)[:, None], dims=("time", "body", "axis"))
            ratios.setdefault("orientation", []).append(_ratio(turn, found["orientation_std"].drop_vars("axis")))
    for name, each in ratios.items():
        known = np.array(each)[np.isfinite(each)]
        assert np.sqrt(np.mean(known**2)) == pytest.approx(1.0, abs=0.4), name
        assert np.mean(np.abs(known) < 1.96) > 0.85, name


def _ratio(error: xr.DataArray, std: xr.DataArray) -> np.ndarray:
    """At a few times, NaN for what is known exactly."""
    taken = {"time": [50, 120, 200]}
    known = std.isel(taken).values
    return error.isel(taken).values / np.where(known > 0.0, known, np.nan)


def test_noise_makes_position_less_certain_with_time(turning, sensors, three) -> None:
    motion = turning(SHORT)
    found = rigid_body_motion(recorded(Accelerometer(), motion, sensors(three, SHORT)), start_of(motion))
    for name in ("orientation", "velocity", "position"):
        std = found[f"{name}_std"].values[:, 0]
        assert (std[0] == 0.0).all()
        assert (std[-1] > std[50]).all()


def test_noise_that_was_filtered_grows_faster_than_its_size_says(sensors) -> None:
    """By the root of the samples that make one independent one."""
    plain, filtered = (rigid_body_motion(_noisy_line(sensors, cfc), _at_rest()) for cfc in (0, 180))
    ratio = float(filtered["velocity_std"][-1, 0, 0] / plain["velocity_std"][-1, 0, 0])
    assert ratio == pytest.approx(np.sqrt(16.05), rel=0.01)


def _noisy_line(sensors, cfc: int) -> xr.Dataset:
    noise = np.random.default_rng(1).normal(size=(1501, 1, 1))
    return sensors([[0.0]], TIMES, axes="x", cfc=cfc).assign(acceleration=(("time", "sensor", "axis"), noise))


def _at_rest() -> xr.Dataset:
    zero = (("body", "axis"), [[0.0]])
    return xr.Dataset({"position": zero, "velocity": zero}, {"body": ["car"], "axis": ["x"]})


def test_centripetal_terms_tell_more_of_a_fast_rotation_than_its_acceleration_does(sensors) -> None:
    """At 40 rad/s two sensors 1 m apart feel it at every sample; integration alone would lose it by sqrt(n) h sigma / |d|."""
    steps = len(SHORT) - 1
    turn = Rotation.from_rotvec(np.outer(40.0 * SHORT, [0.0, 0.0, 1.0])).as_quat(scalar_first=True)
    zero = np.zeros((len(SHORT), 1, 3))
    dims = ("time", "body", "axis")
    values = dict.fromkeys(QUANTITIES, (dims, zero)) | {"angular_velocity": (dims, zero + [0.0, 0.0, 40.0])}
    values["orientation"] = (("time", "body", "quaternion"), turn[:, None])
    motion = xr.Dataset(values, {"time": SHORT, "body": ["car"], "axis": list("xyz")})
    instrument = recorded(Accelerometer(), motion, sensors([[0.5, 0.0], [-0.5, 0.0]], SHORT, axes="xy", std=5.0))
    found = rigid_body_motion(instrument, start_of(motion))
    integrated = 5.0 * np.sqrt(2.0 * steps) * (SHORT[1] - SHORT[0])
    assert float(found["angular_velocity_std"][-1, 0, 2]) < 0.4 * integrated
    assert np.abs(found["angular_velocity"] - motion["angular_velocity"]).max() < 4.0 * 0.4 * integrated


@pytest.mark.parametrize(
    ("points", "axes", "message"),
    [
        (
            [[0.1, 0.2, 0.3]],
            "xyz",
            "car: expected sensors that see all of its motion, found none that sees its rotation about s0, in any direction",
        ),
        ([[0, 0, 0], [1, 0, 0]], "xyz", r"its rotation about the line through s0 and s1, \(1.00, 0.00, 0.00\)"),
        ([[0, 0, 0], [0, 1, 1], [0, 3, 3]], "xyz", r"through s0 and s1 and s2, \(0.00, 0.71, 0.71\)"),
        ([[0.1, 0.2]], "xy", "its rotation about s0, in any direction"),
        ([[0.1, 0.2], [0.1, 0.2]], "xy", "its rotation about s0 and s1, in any direction"),
    ],
)
def test_too_few_sensors_are_refused_with_what_they_do_not_see(sensors, points, axes, message) -> None:
    with pytest.raises(CrashkitError, match=f"accelerometer: the motion cannot be known: .*{message}"):
        Accelerometer().reconstruct(sensors(points, TIMES, axes=axes))


def test_a_body_with_enough_sensors_is_told_beside_one_without(turning, sensors, three) -> None:
    instrument = recorded(Accelerometer(), turning(SHORT), sensors([*three, [0.0, 0.0, 0.0]], SHORT))
    instrument["sensor_body"] = ("sensor", ["car", "car", "car", "engine"])
    found = Accelerometer().reconstruct(instrument)
    assert found["body"].values.tolist() == ["car"]
    assert found.attrs["unknown"].startswith("engine: expected sensors that see all of its motion")


def test_several_bodies_are_told_together(turning, sensors, three) -> None:
    cars = [turning(SHORT), turning(SHORT, 0.2, 0.1, 0.3).assign_coords(body=["trailer"])]
    motion = xr.concat(cars, dim="body")
    instrument = sensors([*three, *three], SHORT)
    instrument["sensor_body"] = ("sensor", ["car", "trailer"] * 3)
    instrument["sensor_point"] = (("sensor", "axis"), np.repeat(three, 2, axis=0))
    found = rigid_body_motion(perfect(motion, instrument), start_of(motion))
    assert found["body"].values.tolist() == ["car", "trailer"]
    np.testing.assert_allclose(found["position"], motion["position"], atol=1e-4)


def test_a_body_said_not_to_turn_needs_one_sensor(turning, sensors) -> None:
    motion = turning(SHORT, 0.0, 0.0, 0.0)
    instrument = recorded(Accelerometer(), motion, sensors([[0.1, 0.2, 0.3]], SHORT, std=1e-3))
    found = rigid_body_motion(instrument, start_of(motion), turning=False)
    np.testing.assert_allclose(found["position"], motion["position"], atol=1e-5)
    assert "orientation" not in found


def test_sensors_with_the_axes_of_the_laboratory_tell_the_acceleration_of_their_centre(turning, sensors) -> None:
    motion = turning(SHORT)
    about = [[0.2, 0.0, 0.0], [-0.1, 0.2, 0.0], [-0.1, -0.2, 0.0]]
    found = Accelerometer().reconstruct(perfect(motion, sensors(about, SHORT, frame="laboratory")))
    np.testing.assert_allclose(found["acceleration"], motion["acceleration"], atol=1e-9)
    with pytest.raises(CrashkitError, match="expected sensors about its centre of mass, or ones whose axes turn with it"):
        Accelerometer().reconstruct(sensors([[0.2, 0.0, 0.0]], SHORT, frame="laboratory"))


def test_readings_of_a_body_that_is_not_rigid_disagree(turning, sensors, three) -> None:
    motion = turning(SHORT)
    instrument = recorded(Accelerometer(), motion, sensors([*three, [0.1, 0.1, 0.4]], SHORT))
    assert float(rigid_body_motion(instrument)["disagreement"][0]) == pytest.approx(1.0, abs=0.05)
    wrong = recorded(Accelerometer(), motion, instrument, {"s3": {"gain": 1.1}})
    assert float(rigid_body_motion(wrong)["disagreement"][0]) > 3.0


def test_disagreement_widens_the_uncertainty(turning, sensors, three) -> None:
    """A sensor that is so wrong that no rotation suits the centripetal terms, on a body that hardly turns."""
    motion = turning(SHORT, 0.05, 0.03, 0.02)
    instrument = recorded(Accelerometer(), motion, sensors(three, SHORT))
    wrong = recorded(Accelerometer(), motion, instrument, {"s0": {"gain": 1.5}})
    right, found = rigid_body_motion(instrument), rigid_body_motion(wrong)
    assert float(found["disagreement"][0]) > 30.0
    assert (found["orientation_std"][-1] > 10.0 * right["orientation_std"][-1]).all()


def test_readings_that_no_rotation_explains_are_refused(sensors, three) -> None:
    noise = np.random.default_rng(0).normal(size=(len(SHORT), 3, 3))
    instrument = sensors(three, SHORT).assign(acceleration=(("time", "sensor", "axis"), 1e5 * noise))
    with pytest.raises(CrashkitError, match="car: expected readings of a rigid body, found none that any rotation comes near"):
        rigid_body_motion(instrument)


def test_noise_that_is_not_stated_is_taken_from_what_the_sensors_say_twice(turning, sensors, three) -> None:
    motion = turning(SHORT)
    instrument = recorded(Accelerometer(), motion, sensors(three, SHORT, std=3.0))
    stated = rigid_body_motion(instrument, start_of(motion))
    found = rigid_body_motion(instrument.drop_vars("acceleration_std"), start_of(motion))
    np.testing.assert_allclose(found["position"], stated["position"], atol=1e-7)
    ratio = found["position_std"][-1] / stated["position_std"][-1]
    np.testing.assert_allclose(ratio, 1.0, atol=0.08)
    assert np.isnan(found["disagreement"]).all()


def test_a_short_gap_is_bridged_and_a_long_one_refused(turning, sensors, three) -> None:
    motion = turning(TIMES)
    instrument = perfect(motion, sensors(three, TIMES))
    instrument["acceleration"][500:510, 1] = np.nan
    found = rigid_body_motion(instrument, start_of(motion))
    assert np.isnan(found["position"][500:510]).all()
    after = found.isel(time=slice(510, None))
    np.testing.assert_allclose(after["position"], motion["position"][510:], atol=1e-6)
    instrument["acceleration"][500:560, 1] = np.nan
    with pytest.raises(CrashkitError, match="car: expected gaps of at most 2 % of the record, found 60 samples"):
        rigid_body_motion(instrument)


def test_a_body_without_its_initial_state_is_named(sensors, three) -> None:
    other = _at_rest().assign_coords(body=["engine"])
    with pytest.raises(CrashkitError, match="accelerometer: expected the initial state of car, found none"):
        rigid_body_motion(sensors(three, TIMES), other)


class TestThreeTriaxialContract(ObserverContract):
    @pytest.fixture
    def observer(self) -> Accelerometer:
        return Accelerometer()

    @pytest.fixture
    def motion(self, turning) -> xr.Dataset:
        """No channel turns so near a sample that hysteresis would change its branch within a difference."""
        return turning(np.arange(321) * 5e-4, yaw=0.45)

    @pytest.fixture
    def instrument(self, sensors, three) -> xr.Dataset:
        return sensors(three, np.arange(301) * 5e-4)

    def test_a_missing_sample_stays_missing(self, observer: Accelerometer, instrument: xr.Dataset, motion: xr.Dataset) -> None:
        recording = perfect(motion, instrument)
        recording["acceleration"][150, 1, 1] = np.nan
        for variable in observer.reconstruct(recording).data_vars.values():
            if "time" in variable.dims:
                np.testing.assert_array_equal(np.isnan(variable).any(variable.dims[1:]), np.arange(301) == 150)


class TestTwoBiaxialContract(TestThreeTriaxialContract):
    @pytest.fixture
    def motion(self, plane) -> xr.Dataset:
        return plane(np.arange(321) * 5e-4)

    @pytest.fixture
    def instrument(self, sensors) -> xr.Dataset:
        return sensors([[0.5, 0.1], [-0.6, 0.0]], np.arange(301) * 5e-4, axes="xy")
