"""What instruments make of a run: faults, noise, the filter of SAE J211, hidden frames; and the recording's form."""

import copy
import math
from typing import Any

import numpy as np
import xarray as xr
from attrs import define, field
from scipy.signal import bilinear, butter, lfilter

from benchmarks.blind.world import Trace

MARGIN = 0.02
"""s of signal before and after a recording, so that filters see no ends."""
GRAVITY = 9.81


@define
class Sensor:
    """One channel and its faults, absent by default.

    Arguments:
        body: that carries it.
        noise: standard deviation before the filter, in the channel's unit.
        gain, bias, drift: the reading is gain * value + bias + drift * time.
        shift, shift_at: what is added for good from a time (s) on.
        tilt: rad, towards gravity.
        low, high, soft: where the reading clips, and whether it bends towards that.
        ring: share of the reading that comes through a resonance, its frequency (Hz) and its damping (of critical).
        pitch: lever (m), frequency (Hz) and damping of a turning of the body that shakes the sensor.
        hidden: share of single frames that are hidden.
        block: first and last time (s) of a stretch in which the marker is hidden.
    """

    body: str
    noise: float
    gain: float = 1.0
    bias: float = 0.0
    drift: float = 0.0
    shift: float = 0.0
    shift_at: float = 0.0
    tilt: float = 0.0
    low: float = -math.inf
    high: float = math.inf
    soft: bool = False
    ring: tuple[float, float, float] = (0.0, 1.0, 0.0)
    pitch: tuple[float, float, float] = (0.0, 1.0, 0.0)
    hidden: float = 0.0
    block: tuple[float, float] = (math.inf, math.inf)


@define
class Instrument:
    """A group of a recording: channels that share a clock.

    Arguments:
        observer: "film", "accelerometer" or "load_cell".
        rate: Hz.
        sensors: by name.
        cfc: channel frequency class; 0: unfiltered.
        late, slow: a sample stamped t was taken at t + late + slow * t.
        std_given: whether the recording tells its noise.
    """

    observer: str
    rate: float
    sensors: dict[str, Sensor] = field(factory=dict)
    cfc: int = 0
    late: float = 0.0
    slow: float = 0.0
    std_given: bool = True

    def copy(self) -> "Instrument":
        """A copy that can be changed on its own."""
        return copy.deepcopy(self)

    def stamps(self, duration: float) -> np.ndarray:
        """s, of the samples of a recording."""
        return np.arange(int(round(duration * self.rate))) / self.rate

    def recorded_std(self, sensor: Sensor) -> float:
        """Standard deviation of the noise after the filter."""
        impulse = np.zeros(4001)
        impulse[2000] = 1.0
        return sensor.noise * math.sqrt(float(np.sum(filtered(impulse, self.cfc, self.rate) ** 2)))


def filtered(samples: np.ndarray, cfc: int, rate: float) -> np.ndarray:
    """SAE J211-1: a Butterworth filter of second order, forwards and backwards; class 0 leaves the samples alone."""
    if cfc == 0:
        return samples
    numerator, denominator = butter(2, 2.0775 * cfc, fs=rate)
    once = lfilter(numerator, denominator, samples)
    return np.asarray(lfilter(numerator, denominator, once[::-1])[::-1])


def read(
    instrument: Instrument, sensor: Sensor, trace: Trace, contact: np.ndarray, duration: float, rng: np.random.Generator | None
) -> np.ndarray:
    """The samples of one channel; without `rng` free of noise.

    Arguments:
        instrument, sensor: which.
        trace: what happened, beyond the recording's end by at least MARGIN.
        contact: N, (time of the trace,), on the body of a load cell.
        duration: s.
        rng: of the noise.
    """
    margin = int(round(MARGIN * instrument.rate))
    stamps = np.arange(-margin, len(instrument.stamps(duration)) + margin) / instrument.rate
    true = _signal(instrument.observer, sensor, trace, contact)
    value = _at(instrument.observer, trace, true, sensor, stamps * (1.0 + instrument.slow) + instrument.late)
    value = sensor.gain * math.cos(sensor.tilt) * value + GRAVITY * math.sin(sensor.tilt)
    value += sensor.bias + sensor.drift * stamps + sensor.shift * (stamps >= sensor.shift_at)
    if rng is not None:
        value = value + sensor.noise * rng.standard_normal(len(value))
    if sensor.soft:
        value = sensor.high * np.tanh(value / sensor.high)
    return filtered(np.clip(value, sensor.low, sensor.high), instrument.cfc, instrument.rate)[margin:-margin]


def _signal(observer: str, sensor: Sensor, trace: Trace, contact: np.ndarray) -> np.ndarray:
    """On the instants of the trace, without the errors of the electronics."""
    if observer == "load_cell":
        return contact
    acceleration, step = trace.acceleration[sensor.body], float(trace.time[1])
    lever, frequency, damping = sensor.pitch
    if observer == "film":
        value = trace.position[sensor.body]
        return value + lever * _oscillator(acceleration, step, frequency, damping, (0.0, 0.0, -1.0)) if lever else value
    if lever:
        acceleration = acceleration + lever * _oscillator(acceleration, step, frequency, damping, (-1.0, 0.0, 0.0))
    share, frequency, damping = sensor.ring
    if not share:
        return acceleration
    pulsation = 2.0 * math.pi * frequency
    rung = _oscillator(acceleration, step, frequency, damping, (0.0, 2.0 * damping * pulsation, pulsation**2))
    return (1.0 - share) * acceleration + share * rung


def _oscillator(base: np.ndarray, step: float, frequency: float, damping: float, numerator: tuple[float, ...]) -> np.ndarray:
    """A resonance driven by `base`: numerator(s) / (s^2 + 2 damping w s + w^2), by the trapezoidal rule."""
    pulsation = 2.0 * math.pi * frequency
    digital = bilinear(numerator, (1.0, 2.0 * damping * pulsation, pulsation**2), fs=1.0 / step)
    return np.asarray(lfilter(*digital, base))


def _at(observer: str, trace: Trace, signal: np.ndarray, sensor: Sensor, times: np.ndarray) -> np.ndarray:
    """Before the contact bodies fly freely and nothing pushes."""
    if observer != "film":
        return np.interp(times, trace.time, signal, left=0.0)
    return np.interp(times, trace.time, signal) + trace.velocity[sensor.body][0] * np.minimum(times, 0.0)


def record(
    instruments: dict[str, Instrument],
    trace: Trace,
    contact: np.ndarray,
    duration: float,
    bodies: list[str],
    rng: np.random.Generator,
) -> xr.DataTree:
    """One test as a recording; `bodies` are those that the model knows to move."""
    speed = float(trace.velocity[bodies[0]][0])
    groups = {"initial": _initial(trace, bodies)}
    groups |= {name: _group(one, trace, contact, duration, rng) for name, one in instruments.items() if one.sensors}
    tree = xr.DataTree.from_dict(groups)
    tree.attrs = {"crashkit_schema": "recording/1", "title": f"run at {speed:g} m/s"}
    return tree


def _initial(trace: Trace, bodies: list[str]) -> xr.Dataset:
    variables = {
        "position": (("body", "axis"), [[trace.position[body][0]] for body in bodies], {"units": "m"}),
        "velocity": (("body", "axis"), [[trace.velocity[body][0]] for body in bodies], {"units": "m s-1"}),
    }
    return xr.Dataset(variables, coords={"body": bodies, "axis": ["x"]})


_QUANTITY = {
    "film": ("position", "marker", "m"),
    "accelerometer": ("acceleration", "sensor", "m s-2"),
    "load_cell": ("force", "sensor", "N"),
}


def _group(instrument: Instrument, trace: Trace, contact: np.ndarray, duration: float, rng: np.random.Generator) -> xr.Dataset:
    quantity, channel, units = _QUANTITY[instrument.observer]
    stamps, sensors = instrument.stamps(duration), list(instrument.sensors.values())
    columns = [read(instrument, sensor, trace, contact, duration, rng) for sensor in sensors]
    values = np.where(np.stack([_hidden(sensor, stamps, rng) for sensor in sensors], 1), np.nan, np.stack(columns, 1))
    variables: dict[str, tuple[Any, ...]] = {
        quantity: (("time", channel, "axis"), values[:, :, None], {"units": units}),
        f"{channel}_body": ((channel,), [sensor.body for sensor in sensors]),
    }
    if instrument.observer != "load_cell":
        variables[f"{channel}_point"] = ((channel, "axis"), np.zeros((len(sensors), 1)), {"units": "m"})
    if instrument.std_given:
        variables[f"{quantity}_std"] = ((channel,), [instrument.recorded_std(sensor) for sensor in sensors], {"units": units})
    coords = {"time": ("time", stamps, {"units": "s"}), channel: list(instrument.sensors), "axis": ["x"]}
    return xr.Dataset(variables, coords=coords, attrs=_attributes(instrument))


def _attributes(instrument: Instrument) -> dict[str, object]:
    attributes: dict[str, object] = {"observer": instrument.observer}
    if instrument.observer != "film":
        attributes["channel_frequency_class"] = instrument.cfc
    if instrument.observer == "accelerometer":
        attributes["frame"] = "laboratory"
    return attributes


def _hidden(sensor: Sensor, stamps: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return (rng.random(len(stamps)) < sensor.hidden) | ((stamps >= sensor.block[0]) & (stamps <= sensor.block[1]))
