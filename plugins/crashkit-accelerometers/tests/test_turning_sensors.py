"""Accelerometers on bodies that turn, in the plane and in space."""

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

from crashkit.errors import CrashkitError
from crashkit_accelerometers import Accelerometer

TIMES = np.arange(301) * 5e-4
VECTORS = ("acceleration", "angular_velocity", "angular_acceleration")
POINT = [0.3, -0.2, 0.5]


def rotations(motion: xr.Dataset) -> Rotation:
    return Rotation.from_quat(motion["orientation"].values[:, 0], scalar_first=True)


@pytest.mark.parametrize("frame", ["body", "laboratory"])
def test_a_sensor_feels_the_second_derivative_of_its_path(turning, sensors, frame) -> None:
    fine = np.arange(-2, 303) * 5e-4
    motion = turning(fine)
    path = motion["position"].values[:, 0] + rotations(motion).apply(POINT)
    felt = (-path[:-4] + 16 * path[1:-3] - 30 * path[2:-2] + 16 * path[3:-1] - path[4:]) / (12 * 5e-4**2)
    if frame == "body":
        felt = rotations(motion)[2:-2].inv().apply(felt)
    predicted = Accelerometer().predict(motion, sensors([POINT], fine[2:-2], frame=frame))["acceleration"]
    np.testing.assert_allclose(predicted[:, 0], felt, atol=2e-3 * np.abs(felt).max())


def test_at_the_centre_of_rotation_at_constant_rate_nothing_but_centripetal_acceleration_is_felt(sensors) -> None:
    """omega = 10 rad/s about z, 0.2 m away: 20 m/s2 inwards, whatever the orientation."""
    zero = np.zeros((len(TIMES), 1, 3))
    dims = ("time", "body", "axis")
    turn = Rotation.from_rotvec(np.outer(10.0 * TIMES, [0, 0, 1])).as_quat(scalar_first=True)
    spin = zero + np.array([0.0, 0.0, 10.0])
    variables = {"acceleration": (dims, zero), "angular_velocity": (dims, spin), "angular_acceleration": (dims, zero)}
    variables["orientation"] = (("time", "body", "quaternion"), turn[:, None])
    motion = xr.Dataset(variables, {"time": TIMES, "body": ["car"], "axis": list("xyz")})
    felt = Accelerometer().predict(motion, sensors([[0.2, 0.0, 0.0]], TIMES))["acceleration"].values[:, 0]
    np.testing.assert_allclose(felt, np.broadcast_to([-20.0, 0.0, 0.0], felt.shape), atol=1e-12)


def test_a_sensor_records_only_its_own_axes(turning, sensors) -> None:
    motion = turning(TIMES)
    whole = Accelerometer().predict(motion, sensors([POINT], TIMES))["acceleration"]
    sensor = sensors([[POINT[0], POINT[2]]], TIMES, axes="xz")
    part = Accelerometer().predict(motion, sensor, {"s0": {"position_y": POINT[1]}})["acceleration"]
    np.testing.assert_allclose(part.values, whole.isel(axis=[0, 2]).values, atol=1e-12)


def differentiated(motion_of, step: float) -> xr.Dataset:
    """A motion with sensitivities to its parameters, by central differences of the motion itself."""
    motion = motion_of()
    changed = []
    for name in ("yaw", "brake"):
        ahead, behind = motion_of(**{name: NOMINAL[name] + step}), motion_of(**{name: NOMINAL[name] - step})
        change = {vector: (ahead[vector] - behind[vector]).values / (2 * step) for vector in VECTORS}
        change["rotation"] = (rotations(ahead) * rotations(behind).inv()).as_rotvec()[:, None] / (2 * step)
        changed.append(change)
    dims = ("time", "body", "axis", "parameter")
    columns = {f"{name}_sensitivity": (dims, np.stack([change[name] for change in changed], axis=-1)) for name in changed[0]}
    return motion.assign(columns).assign_coords(parameter=list(NOMINAL))


NOMINAL = {"yaw": 0.5, "brake": 1.0}


@pytest.mark.parametrize("frame", ["body", "laboratory"])
@pytest.mark.parametrize("errors", [{}, {"s1": {"gain": 1.2, "tilt_y": 0.1, "transverse_x": 0.05, "quadratic": 1e-4}}])
def test_sensitivities_follow_the_chain_rule(turning, plane, sensors, frame, errors) -> None:
    for motion_of in (lambda **k: turning(TIMES, **k), lambda **k: plane(TIMES, **k)):
        instrument = sensors([POINT, [-0.4, 0.1, 0.2]], TIMES, frame=frame, cfc=60)
        found = Accelerometer().predict(differentiated(motion_of, 1e-4), instrument, errors)["acceleration_sensitivity"]
        for column, (name, value) in enumerate(NOMINAL.items()):
            ahead, behind = (
                Accelerometer().predict(motion_of(**{name: value + step}), instrument, errors)["acceleration"].values
                for step in (1e-4, -1e-4)
            )
            expected = (ahead - behind) / 2e-4
            np.testing.assert_allclose(found[..., column], expected, atol=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("missing", ["angular_velocity", "angular_acceleration", "acceleration"])
def test_a_motion_that_turns_but_lacks_a_quantity_is_refused(turning, sensors, missing) -> None:
    with pytest.raises(CrashkitError, match=f"accelerometer: expected a motion with {missing}, found none"):
        Accelerometer().predict(turning(TIMES).drop_vars(missing), sensors([POINT], TIMES))


def test_sensitivities_without_that_of_the_rotation_are_refused(turning, sensors) -> None:
    motion = differentiated(lambda **k: turning(TIMES, **k), 1e-4).drop_vars("rotation_sensitivity")
    with pytest.raises(CrashkitError, match="expected a motion with rotation_sensitivity, found none"):
        Accelerometer().predict(motion, sensors([POINT], TIMES))
