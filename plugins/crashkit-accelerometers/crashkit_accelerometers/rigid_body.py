"""The motion of rigid bodies from their accelerometers alone, with its uncertainty."""

import numpy as np
import xarray as xr
from attrs import evolve, frozen
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from crashkit.data.channel_filter import correlation_samples, frequency_class
from crashkit.errors import CrashkitError
from crashkit_accelerometers.angular_motion import AngularMotion
from crashkit_accelerometers.error_specs import AXES
from crashkit_accelerometers.error_state import Path, standard_deviations
from crashkit_accelerometers.orientation import orientations
from crashkit_accelerometers.rotations import matrices
from crashkit_accelerometers.sensor_array import SensorArray, sensor_arrays

UNITS = {
    "position": "m",
    "velocity": "m s-1",
    "acceleration": "m s-2",
    "orientation": "1",
    "angular_velocity": "rad s-1",
    "angular_acceleration": "rad s-2",
}
LONGEST_GAP = 0.02
"""Of the record; a longer gap is not bridged."""
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
"""The orientation of a body whose axes are those of the laboratory."""
OFF_CENTRE = 1e-3
"""m"""


def rigid_body_motion(instrument: xr.Dataset, initial: xr.Dataset | None = None, turning: bool = True) -> xr.Dataset:
    """The motion of the bodies that carry accelerometers, and how well it is known.

    Three triaxial sensors that are not in line tell all of a body's motion, in the plane two sensors of two axes; more are
    better. On a line, and where bodies are taken not to turn, one is enough.

    Arguments:
        instrument: an accelerometer group.
        initial: `position` and `velocity` (body, axis) at t = 0, and, where they are not 0, `angular_velocity` (body, axis)
            and `orientation` (body, quaternion); before the first sample the motion is uniform.
        turning: False: take the bodies not to turn, whatever their sensors say. Sensors with the axes of the laboratory tell
            no rotation; about the centre of mass they tell its acceleration all the same.

    Returns:
        A motion (time, body, axis): acceleration, with `initial` also velocity and position, and where bodies turn
        angular_velocity, angular_acceleration and orientation. Each has its standard deviation `<name>_std` (time, body,
        axis), that of the orientation as a small rotation vector in the laboratory frame, rad. NaN where a sample is missing.
        `disagreement` (body): the size of what the redundant readings say against a rigid body, over the noise that was
        stated; about 1 where there is nothing but noise, and what it is above 1 widens the standard deviations. The attribute
        `unknown` says which bodies are left out, and why.

    Raises CrashkitError where no body's motion can be known, saying what is missing.
    """
    own_axes = instrument.attrs.get("frame") == "body"
    arrays = sensor_arrays(instrument, turning and own_axes)
    unknown = {array.body: reason for array in arrays if (reason := _unknown(array, turning and not own_axes))}
    sentences = [f"{body}: {reason}" for body, reason in unknown.items()]
    known = [array for array in arrays if array.body not in unknown]
    if not known:
        raise CrashkitError(f"accelerometer: the motion cannot be known: {'; '.join(sentences)}")
    motion = xr.concat([_body_motion(array, instrument, initial) for array in known], dim="body")
    return motion.assign_attrs(unknown="; ".join(sentences))


def _unknown(array: SensorArray, axes_stay: bool) -> str:
    """Why the motion of a body cannot be known; empty where it can."""
    if axes_stay and len(array.recorded) > 1 and np.abs(array.centre).max() > OFF_CENTRE:
        return 'expected sensors about its centre of mass, or ones whose axes turn with it, found frame "laboratory"'
    unseen = array.unseen()
    return f"expected sensors that see all of its motion, found none that sees its {'; '.join(unseen)}" if unseen else ""


@frozen(eq=False)
class _Start:
    """The state at the first sample; position and velocity None where they are not known."""

    position: np.ndarray | None
    velocity: np.ndarray | None
    omega: np.ndarray
    orientation: np.ndarray


def _body_motion(array: SensorArray, instrument: xr.Dataset, initial: xr.Dataset | None) -> xr.Dataset:
    times = instrument["time"].values.astype(float)
    start = _start(array, initial, times[0])
    if instrument.attrs.get("frame") != "body":
        start = evolve(start, orientation=UPRIGHT)
    readings, missing = _readings(array, instrument, times)
    cfc = frequency_class(instrument)
    correlation = correlation_samples(cfc, float(np.median(np.diff(times))))
    angular = AngularMotion(array, times, readings, correlation, start.omega)
    orientation = orientations(times, angular.omega, angular.alpha, start.orientation)
    path = _path(angular, matrices(orientation), np.average(readings, axis=1, weights=array.std**-2))
    quantities = {"acceleration": path.acceleration, **_moved(angular, times, path, start)}
    if len(array.rotations):
        quantities |= {"angular_velocity": path.omega, "angular_acceleration": path.alpha, "orientation": orientation}
    stated = "acceleration_std" in instrument
    found = angular.disagreement if len(array.redundant) else np.nan
    deviations = standard_deviations(angular, path, np.diff(times), correlation)
    scale = np.fmax(1.0, found) if stated else found
    variables = {}
    for name, values in quantities.items():
        last = "quaternion" if name == "orientation" else "axis"
        variables[name] = _variable(array, values, missing, last, UNITS[name])
        units = "rad" if name == "orientation" else UNITS[name]
        variables[f"{name}_std"] = _variable(array, scale * deviations[name], missing, "axis", units)
    variables["disagreement"] = xr.Variable("body", [found if stated else np.nan], {"units": "1"})
    axes = AXES if len(array.rotations) else [AXES[axis] for axis in array.recorded]
    coordinates = {"time": instrument["time"], "body": [array.body], "axis": list(axes)}
    return xr.Dataset(variables, coordinates)


def _readings(array: SensorArray, instrument: xr.Dataset, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Along x, y and z, 0 where not recorded, (time, sensor, 3), and which samples were missing; short gaps are bridged."""
    samples = instrument["acceleration"].transpose("time", "sensor", "axis").sel(sensor=list(array.sensors)).values
    missing = ~np.isfinite(samples).all(axis=(1, 2))
    present = np.flatnonzero(~missing)
    longest = int(np.diff(present, prepend=-1, append=len(times)).max()) - 1
    if longest > max(1, LONGEST_GAP * len(times)):
        raise CrashkitError(
            f"accelerometer: {array.body}: expected gaps of at most 2 % of the record, found {longest} samples"
        )
    readings = np.zeros((*samples.shape[:2], 3))
    readings[..., list(array.recorded)] = CubicSpline(times[present], samples[present])(times) if missing.any() else samples
    return readings, missing


def _start(array: SensorArray, initial: xr.Dataset | None, first: float) -> _Start:
    """The state at the first sample, from that at t = 0, as the motion is uniform before contact."""
    none = np.zeros(3)
    if initial is None:
        return _Start(None, None, none, UPRIGHT)
    if array.body not in initial["body"].values:
        raise CrashkitError(f"accelerometer: expected the initial state of {array.body}, found none")
    own = initial.sel(body=array.body)
    position, velocity, omega = (_along_axes(own, name) for name in ("position", "velocity", "angular_velocity"))
    orientation = Rotation.identity()
    if "orientation" in own:
        orientation = Rotation.from_quat(own["orientation"].values, scalar_first=True)
    turned = Rotation.from_rotvec(first * omega) * orientation
    return _Start(position + first * velocity, velocity, turned.inv().apply(omega), turned.as_quat(scalar_first=True))


def _along_axes(state: xr.Dataset, name: str) -> np.ndarray:
    return state[name].reindex(axis=list(AXES), fill_value=0.0).values if name in state else np.zeros(3)


def _path(angular: AngularMotion, rotation: np.ndarray, push: np.ndarray) -> Path:
    """The motion in the laboratory frame, given the acceleration of the barycentre in the body's axes."""
    omega, alpha = angular.omega, angular.alpha
    offset = -angular.array.centre
    own = push + np.cross(alpha, offset) + np.cross(omega, np.cross(omega, offset))
    push, own, omega, alpha = (np.einsum("tij,tj->ti", rotation, vector) for vector in (push, own, omega, alpha))
    return Path(rotation, push, own, omega, alpha)


def _moved(angular: AngularMotion, times: np.ndarray, path: Path, start: _Start) -> dict[str, np.ndarray]:
    """Velocity and position of the centre of mass, by integration of the barycentre's acceleration."""
    if start.position is None or start.velocity is None:
        return {}
    arm = -path.rotation @ angular.array.centre
    swing = np.cross(path.omega, arm)
    gained = CubicSpline(times, path.push).antiderivative()
    velocity = start.velocity - swing[0] + gained(times)
    moved = gained.antiderivative()(times) + (times - times[0])[:, None] * (start.velocity - swing[0])
    return {"velocity": velocity + swing, "position": start.position - arm[0] + moved + arm}


def _variable(array: SensorArray, values: np.ndarray, missing: np.ndarray, last: str, units: str) -> xr.Variable:
    """Of one body, (time, body, last), along the axes that it can move in, NaN where samples are missing."""
    kept = values if len(array.rotations) else values[:, list(array.recorded)]
    return xr.Variable(("time", "body", last), np.where(missing[:, None], np.nan, kept)[:, None], {"units": units})
