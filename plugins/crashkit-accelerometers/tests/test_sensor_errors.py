"""What each error of a sensor does to its reading, alone and in the order of the measuring chain."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lsim
from scipy.spatial.transform import Rotation

from crashkit.data.channel_filter import filter_channel
from crashkit.data.ringing import ringing, ringing_derivatives
from crashkit.errors import CrashkitError
from crashkit_accelerometers import Accelerometer
from crashkit_accelerometers.hysteresis import branch

TIMES = np.arange(801) * 1e-4
PULSE = 200.0 * np.sin(30.0 * np.pi * TIMES) ** 2 * np.cos(7.0 * TIMES)


def line_motion(values: np.ndarray = PULSE) -> xr.Dataset:
    return xr.Dataset(
        {"acceleration": (("time", "body", "axis"), values[:, None, None])}, {"time": TIMES, "body": ["car"], "axis": ["x"]}
    )


@pytest.fixture
def read(sensors):
    """The reading of a sensor on a line, with errors, unfiltered."""

    def read(errors: dict[str, float], values: np.ndarray = PULSE, cfc: int = 0) -> np.ndarray:
        clock = {name: errors.pop(name) for name in ("clock_offset", "clock_rate") if name in errors}
        instrument = sensors([[0.0]], TIMES, axes="x", cfc=cfc)
        predicted = Accelerometer().predict(line_motion(values), instrument, {"s0": errors, "": clock})
        return predicted["acceleration"].values[:, 0, 0]

    return read


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        ({"gain": 1.1}, 1.1 * PULSE),
        ({"bias": -3.0}, PULSE - 3.0),
        ({"bias_drift": 50.0}, PULSE + 50.0 * TIMES),
        ({"tilt_y": 0.2}, np.cos(0.2) * PULSE),
        ({"tilt_x": 0.2}, PULSE),
        ({"lean": -0.3}, np.cos(0.3) * PULSE - 9.80665 * np.sin(0.3)),
        ({"quadratic": 1e-4}, PULSE + 1e-4 * PULSE**2),
        ({"cubic": -1e-6}, PULSE - 1e-6 * PULSE**3),
        ({"saturation": 120.0}, np.minimum(PULSE, 120.0)),
        ({"saturation_above": 120.0}, np.minimum(PULSE, 120.0)),
        ({"saturation_below": 120.0}, PULSE),
        ({"gain": -1.0, "saturation_below": 120.0}, np.maximum(-PULSE, -120.0)),
        ({"gain": -1.0, "saturation_above": 120.0}, -PULSE),
        ({"saturation_soft": 200.0}, 200.0 * np.tanh(PULSE / 200.0)),
        ({"saturation_knee": 150.0, "knee_sharpness": 4.0}, PULSE / (1.0 + (np.abs(PULSE) / 150.0) ** 4) ** 0.25),
        ({"zero_shift": 4.0, "zero_shift_time": 0.02, "zero_shift_rise": 1e-5}, PULSE + 4.0 * np.heaviside(TIMES - 0.02, 0.5)),
        ({"clock_offset": 2e-3}, np.interp(TIMES - 2e-3, TIMES, PULSE)),
        ({"clock_rate": 0.01}, np.interp(0.99 * TIMES, TIMES, PULSE)),
        ({"transverse_y": 0.1, "position_x": 0.1}, PULSE),
    ],
)
def test_each_error_alone(read, errors, expected) -> None:
    np.testing.assert_allclose(read(errors), expected, atol=1e-9)


def test_gain_comes_before_linearity_saturation_and_offset_and_the_filter_last(read) -> None:
    found = read({"gain": 1.5, "quadratic": 1e-4, "saturation": 250.0, "bias": 7.0, "bias_drift": 90.0}, cfc=180)
    amplified = 1.5 * PULSE
    expected = np.clip(amplified + 1e-4 * amplified**2, -250.0, 250.0) + 7.0 + 90.0 * TIMES
    np.testing.assert_allclose(found, filter_channel(expected, TIMES, 180, before=7.0), atol=1e-9)


def test_gravity_was_there_before_the_filter(read) -> None:
    found = read({"lean": 0.5, "gain": 1.2, "bias": 3.0}, values=0.0 * PULSE, cfc=180)
    np.testing.assert_allclose(found, 1.2 * 9.80665 * np.sin(0.5) + 3.0, atol=1e-9)


@pytest.mark.parametrize(("frequency", "damping"), [(800.0, 0.02), (150.0, 0.3), (4000.0, 0.7)])
def test_a_mount_rings_as_a_mass_on_a_spring_and_a_damper(read, frequency, damping) -> None:
    w = 2 * np.pi * frequency
    system = ([2 * damping * w, w**2], [1.0, 2 * damping * w, w**2])
    _, expected, _ = lsim(system, PULSE, TIMES)
    found = read({"resonance_share": 1.0, "resonance_frequency": frequency, "resonance_damping": damping})
    np.testing.assert_allclose(found, expected, atol=1e-8)
    part = read({"resonance_share": 0.4, "resonance_frequency": frequency, "resonance_damping": damping})
    np.testing.assert_allclose(part, 0.6 * PULSE + 0.4 * expected, atol=1e-8)


def test_of_a_sensing_element_what_its_spring_bears_is_read(read) -> None:
    w, damping = 2 * np.pi * 800.0, 0.1
    _, expected, _ = lsim(([w**2], [1.0, 2 * damping * w, w**2]), PULSE, TIMES)
    element = {"resonance_share": 1.0, "resonance_frequency": 800.0, "resonance_damping": damping, "resonance_path": 0.0}
    np.testing.assert_allclose(read(element), expected, atol=1e-8)


def test_after_a_step_the_mount_rings_at_its_frequency_and_dies_by_its_damping() -> None:
    times = np.arange(4000) * 1e-5
    rung = ringing(np.ones((4000, 1, 1)), times, np.array([500.0]), np.array([0.05]))[:, 0, 0]
    peaks = np.flatnonzero((rung[1:-1] > rung[:-2]) & (rung[1:-1] > rung[2:])) + 1
    np.testing.assert_allclose(np.diff(times[peaks]), 1 / (500 * np.sqrt(1 - 0.05**2)), atol=2e-5)
    heights = np.log(rung[peaks] - 1.0)
    np.testing.assert_allclose(np.diff(heights), -2 * np.pi * 0.05 / np.sqrt(1 - 0.05**2), rtol=2e-3)


def test_uneven_samples_ring_the_same() -> None:
    """The input is linear between samples, so that leaving some in between out changes nothing."""
    times = np.arange(201) * 1e-4
    values = np.interp(times, times[::4], np.sin(90 * times[::4]))
    kept = np.sort(np.concatenate([np.arange(0, 201, 4), [1, 2, 6, 99, 141]]))
    mount = np.array([700.0]), np.array([0.1])
    whole = ringing(values[:, None, None], times, *mount)[kept]
    np.testing.assert_allclose(ringing(values[kept][:, None, None], times[kept], *mount), whole, atol=1e-10)


def test_derivatives_of_the_ringing_agree_with_differences() -> None:
    signal, mount = PULSE[:, None, None], (np.array([600.0]), np.array([0.1]))
    by_frequency, by_damping = ringing_derivatives(signal, TIMES, *mount)
    for found, step in ((by_frequency, (1e-2, 0.0)), (by_damping, (0.0, 1e-6))):
        ahead, behind = (ringing(signal, TIMES, mount[0] + s * step[0], mount[1] + s * step[1]) for s in (1, -1))
        expected = (ahead - behind) / (2 * sum(step))
        np.testing.assert_allclose(found, expected, atol=1e-6 * np.abs(expected).max())


def test_a_reading_with_hysteresis_falls_on_another_way_than_it_rose(read) -> None:
    triangle = np.interp(TIMES, [0.0, 0.02, 0.06, 0.08], [0.0, 400.0, -400.0, 0.0])
    lag = triangle - read({"hysteresis": 5.0, "hysteresis_travel": 20.0}, triangle)
    rising, falling = np.interp(0.015, TIMES, lag), np.interp(0.045, TIMES, lag)
    assert rising == pytest.approx(5.0, rel=1e-3)
    assert falling == pytest.approx(-5.0, rel=1e-3)


@given(st.lists(st.floats(-50, 50), min_size=2, max_size=20), st.integers(2, 7))
def test_hysteresis_does_not_depend_on_how_fast_it_is_gone_through(turns, slower) -> None:
    signal = np.array(turns)[:, None]
    steps = np.arange(len(turns))
    slow = np.interp(np.arange(slower * (len(turns) - 1) + 1) / slower, steps, signal[:, 0])[:, None]
    travel = np.array([10.0])
    np.testing.assert_allclose(branch(slow, travel).position[::slower], branch(signal, travel).position, atol=1e-9)
    assert np.abs(branch(signal, travel).position).max() <= 1.0


def test_a_tilted_sensor_senses_along_turned_axes(turning, sensors) -> None:
    motion, instrument = turning(TIMES), sensors([[0.1, 0.2, 0.3]], TIMES)
    straight = Accelerometer().predict(motion, instrument)["acceleration"].values[:, 0]
    tilt = {"tilt_x": 0.1, "tilt_y": -0.3, "tilt_z": 0.2}
    tilted = Accelerometer().predict(motion, instrument, {"s0": tilt})["acceleration"].values[:, 0]
    np.testing.assert_allclose(tilted, Rotation.from_rotvec(list(tilt.values())).inv().apply(straight), atol=1e-9)


def test_transverse_sensitivity_is_a_share_of_what_happens_across(turning, sensors) -> None:
    motion, instrument = turning(TIMES), sensors([[0.1, 0.2, 0.3]], TIMES)
    x, y, z = Accelerometer().predict(motion, instrument)["acceleration"].values[:, 0].T
    read = Accelerometer().predict(motion, instrument, {"s0": {"transverse_y": 0.03}})["acceleration"].values[:, 0]
    np.testing.assert_allclose(read, np.stack([x + 0.03 * y, y, z + 0.03 * y], axis=1), atol=1e-9)


def test_a_sensor_beside_its_point_reads_what_a_sensor_there_would(turning, sensors) -> None:
    motion = turning(TIMES)
    beside = Accelerometer().predict(
        motion, sensors([[0.1, 0.2, 0.3]], TIMES), {"s0": {"position_x": 0.05, "position_z": -0.1}}
    )
    there = Accelerometer().predict(motion, sensors([[0.15, 0.2, 0.2]], TIMES))
    np.testing.assert_allclose(beside["acceleration"], there["acceleration"], atol=1e-9)


def test_an_error_of_one_axis_leaves_the_others_alone(turning, sensors) -> None:
    motion, instrument = turning(TIMES), sensors([[0.1, 0.2, 0.3], [0.0, 0.0, 0.0]], TIMES)
    perfect = Accelerometer().predict(motion, instrument)["acceleration"]
    errors = {"s0": {"gain": 1.1}, "s0/y": {"gain": 1.3, "bias": 2.0}}
    read = Accelerometer().predict(motion, instrument, errors)["acceleration"]
    expected = perfect.copy(deep=True)
    expected[:, 0] = perfect[:, 0] * [1.1, 1.3, 1.1] + [0.0, 2.0, 0.0]
    np.testing.assert_allclose(read, expected, atol=1e-9)


def test_a_position_is_of_a_whole_sensor(turning, sensors) -> None:
    with pytest.raises(CrashkitError, match="expected the position errors of whole sensors, found those of single axes"):
        Accelerometer().predict(turning(TIMES), sensors([[0.1, 0.2, 0.3]], TIMES), {"s0/y": {"position_x": 0.1}})


WRONG = {
    "gain": 1.1,
    "bias": 4.0,
    "bias_drift": 30.0,
    "tilt_x": 0.05,
    "tilt_y": -0.04,
    "tilt_z": 0.03,
    "transverse_x": 0.02,
    "transverse_y": -0.03,
    "transverse_z": 0.01,
    "quadratic": 2e-5,
    "cubic": 1e-7,
    "hysteresis": 3.0,
    "hysteresis_travel": 40.0,
    "zero_shift": -12.0,
    "zero_shift_time": 0.02,
    "zero_shift_rise": 4e-3,
    "saturation_soft": 900.0,
    "saturation_knee": 2500.0,
    "knee_sharpness": 2.0,
    "saturation": 500.0,
    "resonance_share": 0.6,
    "resonance_frequency": 700.0,
    "resonance_damping": 0.08,
    "resonance_path": 0.4,
    "position_x": 0.03,
    "position_y": -0.02,
    "position_z": 0.01,
}


def wrong_derivatives(
    motion: xr.Dataset, instrument: xr.Dataset, errors: dict[str, float], name: str, tolerance: float
) -> float:
    """The share of samples where the derivative to one error is not that of a difference."""

    def predict(change: float) -> xr.Dataset:
        wrong = {**errors, name: errors[name] + change}
        clock = {error: wrong.pop(error) for error in ("clock_offset", "clock_rate") if error in wrong}
        return Accelerometer().predict(motion, instrument, {"s0": wrong, "": clock})

    step = 1e-5 * abs(errors[name])
    expected = (predict(step)["acceleration"].values - predict(-step)["acceleration"].values) / (2 * step)
    column = [spec.name for spec in Accelerometer.errors].index(name)
    found = predict(0.0)["acceleration_error_sensitivity"].values[..., column]
    assert np.abs(found).max() > 0.0
    return float(np.mean(np.abs(found - expected) > tolerance * np.abs(expected).max()))


@pytest.mark.parametrize("cfc", [0, 180])
@pytest.mark.parametrize("name", WRONG)
def test_derivatives_to_every_error_hold_among_all_others(turning, sensors, name, cfc) -> None:
    """But at the few samples where a step of the difference crosses the edge of saturation or a turn of hysteresis."""
    instrument = sensors([[0.1, 0.2, 0.3]], TIMES, cfc=cfc)
    assert wrong_derivatives(turning(TIMES, brake=1.5), instrument, WRONG, name, 1e-4) < 0.01


@pytest.mark.parametrize("name", ["saturation_above", "saturation_below"])
def test_derivatives_to_a_limit_of_one_side(sensors, name) -> None:
    motion = line_motion(PULSE - 0.5 * PULSE.max())
    assert wrong_derivatives(motion, sensors([[0.0]], TIMES, axes="x"), {name: 0.3 * PULSE.max()}, name, 1e-4) < 0.01


@pytest.mark.parametrize("name", ["lean", "gain", "bias", "resonance_share"])
def test_derivatives_of_a_sensor_that_leans(sensors, name) -> None:
    errors = {"lean": -0.4, "gain": 1.2, "bias": 2.0} | {key: WRONG[key] for key in WRONG if key.startswith("resonance")}
    assert wrong_derivatives(line_motion(PULSE), sensors([[0.0]], TIMES, axes="x", cfc=180), errors, name, 1e-6) == 0.0


@pytest.mark.parametrize("name", ["clock_offset", "clock_rate"])
def test_derivatives_to_the_clock_hold_among_other_errors(sensors, name) -> None:
    instrument = sensors([[0.0]], TIMES, axes="x", cfc=180)
    errors = {**WRONG, "saturation": 500.0, "clock_offset": 1.03e-3, "clock_rate": 2e-3}
    assert wrong_derivatives(line_motion(), instrument, errors, name, 0.01) == 0.0


def test_at_their_nulls_all_errors_together_change_nothing_to_the_last_digit(turning, sensors) -> None:
    motion, instrument = turning(TIMES), sensors([[0.1, 0.2, 0.3]], TIMES, cfc=180)
    nulls = {spec.name: spec.null for spec in Accelerometer.errors}
    one, other = (Accelerometer().predict(motion, instrument, errors) for errors in (None, {"": nulls}))
    np.testing.assert_array_equal(one["acceleration"], other["acceleration"])
