"""What the instruments make of a trace: faults, noise, the J211 filter, hidden frames, and the recording's form."""

import copy
import math
from typing import Any

import numba
import numpy as np
import xarray as xr
from attrs import define, field

from crashkit.testing.concealed.world import Trace

MARGIN = 0.03  # s of signal before and after the recording, so that filters see no ends
GRID = 1e-5  # s, the spacing of a trace


@define
class Sensor:
    """One channel and its faults, absent by default.

    Arguments:
        body: that carries it.
        noise: standard deviation before any filter, in the channel's unit.
        gain, bias, drift: the reading is gain * value + bias + drift * time.
        limit, soft: where the reading clips, and whether it bends towards the limit.
        ring_share, ring_frequency, ring_damping: how much of the reading comes through a resonant mounting (Hz, of critical).
        hidden: share of single frames that are hidden.
        block: the first and last time of a stretch in which the marker is hidden.
    """

    body: str
    noise: float
    gain: float = 1.0
    bias: float = 0.0
    drift: float = 0.0
    limit: float = math.inf
    soft: bool = False
    ring_share: float = 0.0
    ring_frequency: float = 500.0
    ring_damping: float = 0.02
    hidden: float = 0.0
    block: tuple[float, float] = (math.inf, math.inf)


@define
class Instrument:
    """A group of a recording: channels that share a clock.

    Arguments:
        observer: "film", "accelerometer" or "load_cell".
        rate: Hz.
        sensors: by name; empty when the instrument is not there.
        cfc: channel frequency class, 0 for unfiltered.
        clock_offset: s; a sample stamped t was taken at t + clock_offset.
        std_given: whether the recording tells its noise.
    """

    observer: str
    rate: float
    sensors: dict[str, Sensor] = field(factory=dict)
    cfc: int = 0
    clock_offset: float = 0.0
    std_given: bool = True

    def copy(self) -> "Instrument":
        """A copy that can be changed on its own."""
        return copy.deepcopy(self)

    def times(self, duration: float) -> np.ndarray:
        """Time stamps of a recording, s."""
        return np.arange(int(round(duration * self.rate))) / self.rate

    def recorded_std(self, sensor: Sensor) -> float:
        """Standard deviation of the noise after the filter."""
        return sensor.noise * math.sqrt(noise_gain(self.cfc, self.rate))


def read(instrument: Instrument, sensor: Sensor, trace: Trace, duration: float, rng: np.random.Generator | None) -> np.ndarray:
    """The samples of one channel; without `rng` free of noise."""
    margin = int(round(MARGIN * instrument.rate))
    samples = np.arange(-margin, int(round(duration * instrument.rate)) + margin) / instrument.rate
    true = _true_signal(instrument, sensor, trace)
    value = _interpolate(instrument.observer, trace, true, samples + instrument.clock_offset)
    value = sensor.gain * value + sensor.bias + sensor.drift * samples
    if rng is not None:
        value = value + sensor.noise * rng.standard_normal(len(value))
    if sensor.limit < math.inf:
        clipped = sensor.limit * np.tanh(value / sensor.limit) if sensor.soft else value
        value = np.clip(clipped, -sensor.limit, sensor.limit)
    return j211(value, instrument.cfc, instrument.rate)[margin:-margin]


def _true_signal(instrument: Instrument, sensor: Sensor, trace: Trace) -> np.ndarray:
    if instrument.observer == "film":
        return trace.position[sensor.body]
    if instrument.observer == "load_cell":
        return trace.contact[sensor.body]
    signal = trace.acceleration[sensor.body]
    if sensor.ring_share == 0.0:
        return signal
    return (1.0 - sensor.ring_share) * signal + sensor.ring_share * _ring(signal, sensor.ring_frequency, sensor.ring_damping)


def _interpolate(observer: str, trace: Trace, signal: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Before the contact bodies fly freely and nothing pushes."""
    value = np.interp(times, trace.time, signal, left=0.0)
    if observer != "film":
        return value
    speed = (signal[1] - signal[0]) / GRID
    return np.where(times < 0.0, signal[0] + speed * times, value)


@numba.njit(cache=True)
def _ring(signal: np.ndarray, frequency: float, damping: float) -> np.ndarray:
    """The acceleration of a small mass on a spring and a damper on a base that accelerates by `signal`."""
    pulsation = 2.0 * math.pi * frequency
    out, stretch, rate = np.empty(len(signal)), 0.0, 0.0
    for i in range(len(signal)):
        felt = -pulsation * pulsation * stretch - 2.0 * damping * pulsation * rate
        out[i] = felt
        rate += GRID * (felt - signal[i])
        stretch += GRID * rate
    return out


def j211(value: np.ndarray, cfc: int, rate: float) -> np.ndarray:
    """SAE J211-1 appendix C: a second-order Butterworth filter forwards and backwards; class 0 leaves the samples alone."""
    if cfc == 0:
        return value
    corner = math.tan(math.pi * 2.0775 * cfc / rate)
    scale = 1.0 + math.sqrt(2.0) * corner + corner**2
    forward = corner**2 / scale
    back_1, back_2 = -2.0 * (corner**2 - 1.0) / scale, (-1.0 + math.sqrt(2.0) * corner - corner**2) / scale
    once = _recursion(value, forward, back_1, back_2)
    return _recursion(once[::-1].copy(), forward, back_1, back_2)[::-1].copy()


@numba.njit(cache=True)
def _recursion(value: np.ndarray, forward: float, back_1: float, back_2: float) -> np.ndarray:
    out = np.empty(len(value))
    in_1 = in_2 = out_1 = out_2 = value[0]
    for i in range(len(value)):
        out[i] = forward * (value[i] + 2.0 * in_1 + in_2) + back_1 * out_1 + back_2 * out_2
        in_1, in_2, out_1, out_2 = value[i], in_1, out[i], out_1
    return out


def noise_gain(cfc: int, rate: float) -> float:
    """The share of the variance of white noise that passes the filter."""
    impulse = np.zeros(2001)
    impulse[1000] = 1.0
    return float(np.sum(j211(impulse, cfc, rate) ** 2))


def record(
    instruments: dict[str, Instrument],
    trace: Trace,
    duration: float,
    speed: float,
    bodies: list[str],
    rng: np.random.Generator,
) -> xr.DataTree:
    """One test as a recording of the data contract; `bodies` are those that the model knows to move."""
    groups = {"initial": _initial(trace, speed, bodies)}
    groups |= {
        name: _group(instrument, trace, duration, rng) for name, instrument in instruments.items() if instrument.sensors
    }
    tree = xr.DataTree.from_dict(groups)
    tree.attrs = {"crashkit_schema": "recording/1", "title": f"run at {speed:g} m/s"}
    return tree


def _initial(trace: Trace, speed: float, bodies: list[str]) -> xr.Dataset:
    position = [[trace.position[body][0]] for body in bodies]
    variables = {
        "position": (("body", "axis"), position, {"units": "m"}),
        "velocity": (("body", "axis"), np.full((len(bodies), 1), speed), {"units": "m s-1"}),
    }
    return xr.Dataset(variables, coords={"body": bodies, "axis": ["x"]})


_QUANTITY = {
    "film": ("position", "marker", "m"),
    "accelerometer": ("acceleration", "sensor", "m s-2"),
    "load_cell": ("force", "sensor", "N"),
}


def _group(instrument: Instrument, trace: Trace, duration: float, rng: np.random.Generator) -> xr.Dataset:
    quantity, channel, units = _QUANTITY[instrument.observer]
    times, sensors = instrument.times(duration), list(instrument.sensors.values())
    columns = [read(instrument, sensor, trace, duration, rng) for sensor in sensors]
    hidden = [_hidden(sensor, times, rng) for sensor in sensors]
    values = np.where(np.stack(hidden, 1), np.nan, np.stack(columns, 1))
    variables: dict[str, tuple[Any, ...]] = {
        quantity: (("time", channel, "axis"), values[:, :, None], {"units": units}),
        f"{channel}_body": ((channel,), [sensor.body for sensor in sensors]),
    }
    if instrument.observer != "load_cell":
        variables[f"{channel}_point"] = ((channel, "axis"), np.zeros((len(sensors), 1)), {"units": "m"})
    if instrument.std_given:
        std = [instrument.recorded_std(sensor) for sensor in sensors]
        variables[f"{quantity}_std"] = ((channel,), std, {"units": units})
    coords = {"time": ("time", times, {"units": "s"}), channel: list(instrument.sensors), "axis": ["x"]}
    return xr.Dataset(variables, coords=coords, attrs=_attributes(instrument))


def _attributes(instrument: Instrument) -> dict[str, object]:
    attributes: dict[str, object] = {"observer": instrument.observer}
    if instrument.observer != "film":
        attributes["channel_frequency_class"] = instrument.cfc
    if instrument.observer == "accelerometer":
        attributes["frame"] = "laboratory"
    return attributes


def _hidden(sensor: Sensor, times: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return (rng.random(len(times)) < sensor.hidden) | ((times >= sensor.block[0]) & (times <= sensor.block[1]))
