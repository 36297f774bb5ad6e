"""The errors of sensors from a motion that is known."""

import numpy as np
import pytest
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.protocols import Status
from crashkit_accelerometers import Accelerometer, Calibration, recorded
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity

TIMES = np.arange(601) * 2.5e-4
TRUE = {
    "gain": 1.03,
    "bias": 2.0,
    "bias_drift": 15.0,
    "tilt_y": 0.03,
    "transverse_z": -0.02,
    "quadratic": 2e-5,
    "cubic": 4e-8,
    "hysteresis": 4.0,
    "saturation": 250.0,
    "resonance_share": 0.3,
    "position_y": 0.02,
    "clock_offset": 4e-4,
    "clock_rate": 2e-3,
}
CLOCK = ("clock_offset", "clock_rate")


def found_and_bound(motion: xr.Dataset, instrument: xr.Dataset, place: str, name: str, known: dict) -> tuple[float, float]:
    """The error that is identified, and the least standard deviation that any unbiased estimate has (Cramer and Rao)."""
    recording = recorded(Accelerometer(), motion, instrument, {place: {name: TRUE[name]}}, seed=3)
    problem = Calibration(Accelerometer(), motion, recording, {place: [name]}, known)
    result = run(Sensitivity(), problem)
    assert result.status is Status.CONVERGED
    truth = Calibration(Accelerometer(), motion, recording, {place: [name]}, {place: {name: TRUE[name]}})
    _, jacobian = truth.residual_and_jacobian(truth.start())
    scale = truth.scaling(truth.start())[0]
    return result.values[f"{place}.{name}"], scale / float(np.linalg.norm(jacobian))


@pytest.mark.parametrize("name", TRUE)
def test_each_error_is_found_as_well_as_the_noise_allows(turning, sensors, name) -> None:
    place = "" if name in CLOCK else "s0"
    start = {place: {name: 300.0}} if name == "saturation" else {}
    found, bound = found_and_bound(turning(TIMES), sensors([[0.1, 0.2, 0.3]], TIMES), place, name, start)
    assert found == pytest.approx(TRUE[name], abs=4.0 * bound)
    assert bound < 0.3 * abs(TRUE[name])


def test_several_errors_are_told_apart(turning, sensors) -> None:
    motion, instrument = turning(TIMES), sensors([[0.1, 0.2, 0.3], [0.4, 0.0, 0.0]], TIMES, cfc=180)
    true = {
        "s0": {"gain": 1.02, "tilt_z": 0.01},
        "s0/y": {"bias": 3.0},
        "s1": {"position_x": 0.01},
        "": {"clock_offset": 2e-4},
    }
    recording = recorded(Accelerometer(), motion, instrument, true, seed=1)
    result = run(
        Sensitivity(), Calibration(Accelerometer(), motion, recording, {place: list(own) for place, own in true.items()})
    )
    for place, own in true.items():
        for name, value in own.items():
            row = result.parameters.sel(parameter=f"{place}.{name}")
            assert float(row["value"]) == pytest.approx(value, abs=4.0 * float(row["std"]))
            assert bool(row["identifiable"])


def test_what_the_motion_does_not_show_is_not_identified(plane, sensors) -> None:
    """Nothing happens along z in the plane, so that nothing of it can be picked up."""
    recording = recorded(Accelerometer(), plane(TIMES), sensors([[0.1, 0.2, 0.3]], TIMES))
    result = run(Sensitivity(), Calibration(Accelerometer(), plane(TIMES), recording, {"s0": ["gain", "transverse_z"]}))
    assert result.unseen == ("s0.transverse_z is not seen by these recordings",)


def test_a_gap_is_passed_over(turning, sensors) -> None:
    motion = turning(TIMES)
    recording = recorded(Accelerometer(), motion, sensors([[0.1, 0.2, 0.3]], TIMES), {"s0": {"gain": 1.1}})
    recording["acceleration"][100:200] = np.nan
    problem = Calibration(Accelerometer(), motion, recording, {"s0": ["gain"]})
    assert len(problem.residual(problem.start())) == 3 * 501
    assert run(Sensitivity(), problem).values["s0.gain"] == pytest.approx(1.1, abs=1e-3)


def test_an_error_that_is_not_declared_is_named(turning, sensors) -> None:
    with pytest.raises(CrashkitError, match="accelerometer: expected an error of .*, found 'colour'"):
        Calibration(Accelerometer(), turning(TIMES), sensors([[0.1, 0.2, 0.3]], TIMES), {"s0": ["colour"]})


def test_a_recording_without_its_noise_is_refused(turning, sensors) -> None:
    recording = sensors([[0.1, 0.2, 0.3]], TIMES).drop_vars("acceleration_std")
    with pytest.raises(CrashkitError, match="accelerometer: expected acceleration_std, without which nothing can be weighed"):
        Calibration(Accelerometer(), turning(TIMES), recording, {"s0": ["gain"]})
