"""What instruments make of a motion: faults, noise, and the filter of SAE J211."""

import math

import numpy as np
from attrs import define, field
from scipy.signal import bilinear, butter, lfilter

from crashkit.testing.concealed.world import Motion

MARGIN = 0.02
"""s of signal before and after a recording, so that filters see no ends."""
GRAVITY = 9.81
"""m s-2."""


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
        clock_offset, clock_drift: a sample stamped t was taken at t + clock_offset + clock_drift * t.
        std_given: whether the recording tells its noise.
    """

    observer: str
    rate: float
    sensors: dict[str, Sensor] = field(factory=dict)
    cfc: int = 0
    clock_offset: float = 0.0
    clock_drift: float = 0.0
    std_given: bool = True

    def times(self, duration: float) -> np.ndarray:
        """s, as the samples of a recording are stamped."""
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
    instrument: Instrument, sensor: Sensor, motion: Motion, duration: float, rng: np.random.Generator | None
) -> np.ndarray:
    """The samples of one channel.

    Arguments:
        instrument, sensor: which.
        motion: what happened, beyond the recording's end by at least MARGIN.
        duration: s.
        rng: of the noise; None: there is none.
    """
    margin = int(round(MARGIN * instrument.rate))
    times = np.arange(-margin, len(instrument.times(duration)) + margin) / instrument.rate
    true = _signal(instrument.observer, sensor, motion)
    taken = times * (1.0 + instrument.clock_drift) + instrument.clock_offset
    value = _at(instrument.observer, motion, true, sensor, taken)
    value = sensor.gain * math.cos(sensor.tilt) * value + GRAVITY * math.sin(sensor.tilt)
    value += sensor.bias + sensor.drift * times + sensor.shift * (times >= sensor.shift_at)
    if rng is not None:
        value = value + sensor.noise * rng.standard_normal(len(value))
    if sensor.soft:
        value = sensor.high * np.tanh(value / sensor.high)
    return filtered(np.clip(value, sensor.low, sensor.high), instrument.cfc, instrument.rate)[margin:-margin]


def _signal(observer: str, sensor: Sensor, motion: Motion) -> np.ndarray:
    """On the instants of the motion, without the errors of the electronics."""
    if observer == "load_cell":
        return motion.contact(sensor.body)
    acceleration, step = motion.acceleration[sensor.body], float(motion.time[1])
    lever, frequency, damping = sensor.pitch
    if observer == "film":
        position = motion.position[sensor.body]
        return position + lever * _oscillator(acceleration, step, frequency, damping, (0.0, 0.0, -1.0)) if lever else position
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


def _at(observer: str, motion: Motion, signal: np.ndarray, sensor: Sensor, times: np.ndarray) -> np.ndarray:
    """Before the contact bodies fly freely and nothing pushes."""
    if observer != "film":
        return np.interp(times, motion.time, signal, left=0.0)
    return np.interp(times, motion.time, signal) + motion.velocity[sensor.body][0] * np.minimum(times, 0.0)
