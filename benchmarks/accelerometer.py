"""Three triaxial accelerometers on a tumbling body, and the errors of sensors.

From the readings to orientation, absolute acceleration and position, beside what people write themselves and what libraries
for inertial sensors offer; each sensor error found from a recording, beside the least standard deviation that any unbiased
estimate can have (Cramer and Rao); and the channel filter beside the usual recipe. AHRS and imufusion come from PyPI.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from statistics import median
from types import ModuleType

import numpy as np
import xarray as xr
from scipy.integrate import cumulative_trapezoid
from scipy.signal import butter, filtfilt
from scipy.spatial.transform import Rotation

from benchmarks import Row, pair
from crashkit.data.channel_filter import filter_channel
from crashkit_accelerometers import Accelerometer, Calibration, accelerometers, recorded, rigid_body_motion, tumbling
from crashkit_identifiers.run import run as identified
from crashkit_identifiers.sensitivity import Sensitivity

TIMES = np.arange(1501) * 1e-4
POINTS = {"front": (0.24, 0.0, 0.0), "left": (-0.12, 0.2, 0.0), "right": (-0.12, -0.2, 0.0)}
"""m; the barycentre is the centre of mass, so that its acceleration is the mean."""
NOISE = 1.0
"""m s-2"""
SEEDS = 20
MARKS = {"orientation": 0.095, "acceleration": 0.62, "position": 0.3}
UNITS = {"orientation": "deg", "acceleration": "m s-2", "position": "mm"}
Answer = tuple[Rotation, np.ndarray, np.ndarray]
"""Orientation, and acceleration and position of the centre of mass in the laboratory frame."""
Solver = Callable[[np.ndarray], Answer]
ERRORS: Mapping[str, tuple[str, float]] = {
    "gain": ("front", 1.03),
    "bias": ("front", 2.0),
    "bias_drift": ("front", 15.0),
    "tilt_y": ("front", 0.03),
    "transverse_z": ("front", -0.02),
    "quadratic": ("front", 2e-5),
    "cubic": ("front", 4e-8),
    "hysteresis": ("front", 4.0),
    "saturation": ("front", 250.0),
    "resonance_share": ("front", 0.3),
    "position_y": ("front", 0.02),
    "clock_offset": ("", 4e-4),
    "clock_rate": ("", 2e-3),
}


def run() -> list[Row]:
    """The inverse without and with noise, what it costs, how sure it is; each error; the filter."""
    motion = tumbling(TIMES)
    sensors = accelerometers(POINTS, TIMES, "car", std=NOISE)
    start = motion.isel(time=0, drop=True)[["position", "velocity"]]
    return [
        *_perfect(motion, sensors, start),
        *_noisy(motion, sensors, start),
        *_cost(motion, sensors),
        _coverage(motion, sensors, start),
        *(_identification(motion, sensors, name) for name in ERRORS),
        *_filter(),
    ]


def _perfect(motion: xr.Dataset, sensors: xr.Dataset, start: xr.Dataset) -> list[Row]:
    readings = Accelerometer().predict(motion, sensors)["acceleration"].values
    ours = _errors(_ours(sensors, readings, start), motion)
    rows = []
    for peer, solve in _peers().items():
        theirs = _errors(solve(readings), motion) if solve else {}
        rows += [_row("without noise", quantity, ours, peer, theirs) for quantity in UNITS]
    return rows


def _noisy(motion: xr.Dataset, sensors: xr.Dataset, start: xr.Dataset) -> list[Row]:
    """Medians over draws of the noise: orientation and position at the end, root mean square acceleration."""
    draws = [recorded(Accelerometer(), motion, sensors, seed=seed)["acceleration"].values for seed in range(SEEDS)]
    ours = _medians([_errors(_ours(sensors, readings, start), motion) for readings in draws])
    case = f"{NOISE:g} m/s2 of noise"
    rows = [_row(case, quantity, ours, "mark", MARKS) for quantity in UNITS]
    for peer, solve in _peers().items():
        theirs = _medians([_errors(solve(readings), motion) for readings in draws]) if solve else {}
        rows += [_row(case, quantity, ours, peer, theirs) for quantity in UNITS]
    return rows


def _row(case: str, quantity: str, ours: Mapping[str, float], peer: str, theirs: Mapping[str, float]) -> Row:
    return Row(f"{case}: {quantity}", "error", UNITS[quantity], ours[quantity], peer, theirs.get(quantity))


def _medians(draws: list[dict[str, float]]) -> dict[str, float]:
    return {quantity: median(draw[quantity] for draw in draws) for quantity in UNITS}


def _errors(answer: Answer, motion: xr.Dataset) -> dict[str, float]:
    """deg, m s-2 and mm."""
    rotation, acceleration, position = answer
    truth = Rotation.from_quat(motion["orientation"].values[:, 0], scalar_first=True)
    difference = acceleration - motion["acceleration"].values[:, 0]
    return {
        "orientation": float(np.degrees((rotation[-1] * truth[-1].inv()).magnitude())),
        "acceleration": float(np.sqrt(np.mean(difference**2))),
        "position": 1e3 * float(np.sqrt(np.mean((position[-1] - motion["position"].values[-1, 0]) ** 2))),
    }


def _ours(sensors: xr.Dataset, readings: np.ndarray, start: xr.Dataset) -> Answer:
    found = rigid_body_motion(_with(sensors, readings), start)
    rotation = Rotation.from_quat(found["orientation"].values[:, 0], scalar_first=True)
    return rotation, found["acceleration"].values[:, 0], found["position"].values[:, 0]


def _with(sensors: xr.Dataset, readings: np.ndarray) -> xr.Dataset:
    return sensors.assign(acceleration=(("time", "sensor", "axis"), readings, {"units": "m s-2"}))


def _peers() -> dict[str, Solver | None]:
    ahrs, imufusion = _installed("ahrs"), _installed("imufusion")
    return {
        "step by step": _step_by_step,
        "scipy Rotation": _with_rates(_by_scipy),
        "AHRS AngularRate": _with_rates(lambda omega: _by_ahrs(ahrs, omega)) if ahrs else None,
        "imufusion": _with_rates(lambda omega: _by_imufusion(imufusion, omega)) if imufusion else None,
    }


def _installed(name: str) -> ModuleType | None:
    try:
        return import_module(name)
    except ImportError:
        return None


def _angular(readings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The sensors' points, and the matrix that gives alpha by least squares from readings less their centripetal terms."""
    arms = np.array(list(POINTS.values()))
    design = np.concatenate([np.concatenate([np.eye(3), -_cross(arm)], axis=1) for arm in arms])
    return arms, np.linalg.pinv(design)[3:]


def _cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def _step_by_step(readings: np.ndarray) -> Answer:
    """Euler's rule for omega and for the rotation matrix, as a first script does it."""
    arms, solve = _angular(readings)
    step, omega, turn = TIMES[1] - TIMES[0], np.zeros(3), np.eye(3)
    turns = [turn]
    for reading in readings[:-1]:
        centripetal = np.cross(omega, np.cross(omega, arms))
        omega = omega + step * solve @ (reading - centripetal).ravel()
        turn = turn @ (np.eye(3) + step * _cross(omega))
        turns.append(turn)
    return _integrated(Rotation.from_matrix(np.array(turns)), readings)


def _with_rates(orient: Callable[[np.ndarray], Rotation]) -> Solver:
    """omega by Heun's rule from least squares with its centripetal terms, then orientation by a library."""

    def solve(readings: np.ndarray) -> Answer:
        arms, matrix = _angular(readings)
        step, omega = TIMES[1] - TIMES[0], [np.zeros(3)]

        def alpha(reading: np.ndarray, rate: np.ndarray) -> np.ndarray:
            return np.asarray(matrix @ (reading - np.cross(rate, np.cross(rate, arms))).ravel())

        for now, then in zip(readings[:-1], readings[1:], strict=True):
            first = alpha(now, omega[-1])
            omega.append(omega[-1] + 0.5 * step * (first + alpha(then, omega[-1] + step * first)))
        return _integrated(orient(np.array(omega)), readings)

    return solve


def _by_scipy(omega: np.ndarray) -> Rotation:
    """Each step a rotation by the mean rate."""
    turns = [Rotation.identity()]
    for turn in Rotation.from_rotvec(0.5 * np.diff(TIMES)[:, None] * (omega[1:] + omega[:-1])):
        turns.append(turns[-1] * turn)
    return Rotation.concatenate(turns)


def _by_ahrs(ahrs: ModuleType, omega: np.ndarray) -> Rotation:
    """Which turns from each sample to the next by the rate of the later one: here by the mean."""
    rates = np.concatenate([omega[:1], 0.5 * (omega[1:] + omega[:-1])])
    found = ahrs.filters.AngularRate(gyr=rates, q0=np.array([1.0, 0.0, 0.0, 0.0]), Dt=TIMES[1] - TIMES[0])
    return Rotation.from_quat(found.Q, scalar_first=True)


def _by_imufusion(imufusion: ModuleType, omega: np.ndarray) -> Rotation:
    """In single precision; without leaning on gravity, which a crash drowns."""
    tracker, settings = imufusion.Ahrs(), imufusion.AhrsSettings()
    settings.gain = 0.0
    tracker.set_settings(settings)
    tracker.set_sample_period(TIMES[1] - TIMES[0])
    tracker.skip_startup()
    found = [np.array([1.0, 0.0, 0.0, 0.0])]
    for rate in np.degrees(0.5 * (omega[1:] + omega[:-1])):
        tracker.update_no_magnetometer(rate, np.zeros(3))
        found.append(tracker.get_quaternion())
    return Rotation.from_quat(np.array(found), scalar_first=True)


def _integrated(rotation: Rotation, readings: np.ndarray) -> Answer:
    """The mean of the sensors is the acceleration of their barycentre; twice the trapezoidal rule."""
    acceleration = rotation.apply(readings.mean(axis=1))
    velocity = np.array([15.0, 0.0, 0.0]) + cumulative_trapezoid(acceleration, TIMES, axis=0, initial=0.0)
    return rotation, acceleration, cumulative_trapezoid(velocity, TIMES, axis=0, initial=0.0)


def _cost(motion: xr.Dataset, sensors: xr.Dataset) -> list[Row]:
    readings = Accelerometer().predict(motion, sensors)["acceleration"].values
    recording, scipy = _with(sensors, readings), _with_rates(_by_scipy)
    inverse = pair(lambda: rigid_body_motion(recording), lambda: scipy(readings))
    forward, _ = pair(lambda: Accelerometer().predict(motion, sensors), None)
    return [
        Row(
            "motion and its uncertainty from 1501 samples",
            "time",
            "s",
            inverse[0],
            "scipy Rotation, no uncertainty",
            inverse[1],
        ),
        Row("what three triaxial sensors record, 1501 samples", "time", "s", forward, "", None),
    ]


def _coverage(motion: xr.Dataset, sensors: xr.Dataset, start: xr.Dataset) -> Row:
    """How often the position at the end lies within the 95 % that were stated."""
    inside = []
    for seed in range(SEEDS):
        found = rigid_body_motion(recorded(Accelerometer(), motion, sensors, seed=100 + seed), start).isel(time=-1)
        miss = np.abs(found["position"] - motion["position"].isel(time=-1)) / found["position_std"]
        inside.append(miss.values < 1.96)
    return Row("share of end positions in their 95 % interval", "rate", "1", float(np.mean(inside)), "as stated", 0.95)


def _identification(motion: xr.Dataset, sensors: xr.Dataset, name: str) -> Row:
    """Root mean square error over ten recordings."""
    place, true = ERRORS[name]
    known = {place: {name: 1.3 * true}} if name == "saturation" else {}  # below no reading does it say where to go
    errors = []
    for seed in range(10):
        recording = recorded(Accelerometer(), motion, sensors, {place: {name: true}}, seed=seed)
        found = identified(Sensitivity(), Calibration(Accelerometer(), motion, recording, {place: [name]}, known))
        errors.append(found.values[f"{place}.{name}"] - true)
    at_truth = Calibration(Accelerometer(), motion, recording, {place: [name]}, {place: {name: true}})
    _, jacobian = at_truth.residual_and_jacobian(at_truth.start())
    bound = at_truth.scaling(at_truth.start())[0] / float(np.linalg.norm(jacobian))
    unit = next(spec.unit for spec in Accelerometer.errors if spec.name == name)
    return Row(f"{name} found", "error", unit, float(np.sqrt(np.mean(np.square(errors)))), "Cramer-Rao bound", bound)


def _filter() -> list[Row]:
    """CFC 60 at its cut-off of 100 Hz, where both passes together are to lose 3 dB, and the time for 20 channels."""
    tone = np.cos(2.0 * np.pi * 100.0 * (TIMES - TIMES[750]))
    recipe = butter(2, 100.0, fs=1e4)
    levels = [20.0 * np.log10(it[750]) for it in (filter_channel(tone, TIMES, 60), filtfilt(*recipe, tone))]
    block = np.random.default_rng(0).normal(size=(len(TIMES), 20))
    times = pair(lambda: filter_channel(block, TIMES, 60), lambda: filtfilt(*recipe, block, axis=0))
    peer = "butter and filtfilt at the cut-off"
    return [
        Row("CFC 60: away from -3 dB at 100 Hz", "error", "dB", abs(levels[0] + 3.0), peer, abs(levels[1] + 3.0)),
        Row("CFC 60: 20 channels of 1501 samples", "time", "s", times[0], peer, times[1]),
    ]
