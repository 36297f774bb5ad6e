"""Secrets of an instrument: faults that no structure can cause."""

from typing import Any

import numpy as np
from attrs import evolve

from crashkit.testing.concealed.effect import Answer, Effect, Maker, Stage
from crashkit.testing.concealed.instruments import Sensor
from crashkit.testing.concealed.scene import Scene


def clock_offset(stage: Stage) -> Effect:
    """An instrument's clock is ahead or behind, or behind and slow."""
    name, form = stage.one_of(*stage.scene.instruments), stage.form("ahead", "behind", "slow")
    offset = stage.scene.duration * stage.among(0.005, 0.03) * (-1.0 if form == "ahead" else 1.0)

    def conceal(scene: Scene, strength: float) -> None:
        scene.instruments[name].clock_offset = offset * strength
        scene.instruments[name].clock_drift = 0.1 * offset * strength / scene.duration if form == "slow" else 0.0

    return Effect("clock_offset", form, "instrument", name, {"offset": offset}, conceal, (0.02, 1.5))


def gain_error(stage: Stage) -> Effect:
    """A sensor reads too much or too little; a wall that stops one body cannot be told from that body's mass."""
    group, name, form = *_channel(stage), stage.form("high", "low")
    error = 0.15 if form == "high" else -0.15
    alone = group == "load_cell" and len(stage.scene.bodies) == 1
    rivals: tuple[Answer, ...] = (("added_mass", "body", stage.scene.bodies[0]),) if alone else ()
    effect = _fault("gain_error", form, group, name, {"gain": error}, (0.02, 3.0))
    return evolve(effect, rivals=rivals)


def bias(stage: Stage) -> Effect:
    """A sensor's zero is off: for good, drifting away, or shifted by the shock."""
    group, name, form = *_channel(stage), stage.form("constant", "constant", "drift", "shift")
    size = float(stage.rng.choice([-0.05, 0.05])) * _peak(stage, group, name)
    numbers = {"constant": {"bias": size}, "drift": {"drift": size / stage.scene.duration}, "shift": {"shift": size}}[form]
    rest = {"shift_at": stage.scene.duration * stage.among(0.1, 0.35)} if form == "shift" else {}
    return _fault("bias", form, group, name, numbers, (0.02, 6.0), rest)


def misalignment(stage: Stage) -> Effect | None:
    """A sensor is tilted: it reads a part of what it should, and a part of gravity. One axis shows no more than that."""
    group, name = "accelerometer", _accelerometer(stage)
    effect = _fault("misalignment", "tilt", group, name, {"tilt": 0.3 * float(stage.rng.choice([-1.0, 1.0]))}, (0.1, 2.0))
    return evolve(effect, rivals=(("gain_error", "sensor", name), ("bias", "sensor", name)))


def mounting_resonance(stage: Stage) -> Effect:
    """A sensor rings on its mounting: all of its reading, or a part that comes over a bracket."""
    group, name, form = "accelerometer", _accelerometer(stage), stage.form("mounting", "bracket")
    share = 1.0 if form == "mounting" else stage.among(0.3, 0.6)
    frequency = stage.among(8.0, 50.0) / stage.scene.duration
    damping = stage.among(0.01, 0.08)

    def conceal(scene: Scene, strength: float) -> None:
        scene.instruments[group].sensors[name].ring = (share * strength, frequency, damping)

    numbers = {"share": share, "frequency": frequency, "damping": damping}
    return Effect("mounting_resonance", form, "sensor", name, numbers, conceal, (0.03, 1.0))


def saturation(stage: Stage) -> Effect:
    """A sensor clips: on both sides, on one, or bending towards its limit; strength brings the limit down."""
    group, name, form = *_channel(stage), stage.form("hard", "one_side", "soft")
    peak = _peak(stage, group, name)

    def conceal(scene: Scene, strength: float) -> None:
        limit, sensor = abs(peak) * (1.0 - 0.3 * strength), scene.instruments[group].sensors[name]
        sensor.low = -limit if form != "one_side" or peak < 0.0 else -np.inf
        sensor.high = limit if form != "one_side" or peak > 0.0 else np.inf
        sensor.soft = form == "soft"

    return Effect("saturation", form, "sensor", name, {"peak": peak, "lost": 0.3}, conceal, (0.05, 2.5))


def _channel(stage: Stage) -> tuple[str, str]:
    """An accelerometer or load cell: its group and name."""
    channels = [(group, name) for group, one in stage.scene.instruments.items() if group != "film" for name in one.sensors]
    return channels[int(stage.rng.integers(len(channels)))]


def _accelerometer(stage: Stage) -> str:
    return stage.one_of(*stage.scene.instruments["accelerometer"].sensors)


def _peak(stage: Stage, group: str, name: str) -> float:
    """The true value of largest size in the fastest run that is fitted, in the channel's unit."""
    motion, sensor = stage.motions[-1], stage.scene.instruments[group].sensors[name]
    signal = motion.contact(sensor.body) if group == "load_cell" else motion.acceleration[sensor.body]
    return float(signal[np.argmax(np.abs(signal))])


def _fault(
    physics: str,
    form: str,
    group: str,
    name: str,
    numbers: dict[str, float],
    limits: tuple[float, float],
    rest: dict[str, Any] | None = None,
) -> Effect:
    """A sensor's numbers are off by `strength` times these; `rest` does not depend on the strength."""

    def conceal(scene: Scene, strength: float) -> None:
        sensor: Sensor = scene.instruments[group].sensors[name]
        for key, value in numbers.items():
            setattr(sensor, key, getattr(sensor, key) + strength * value)
        for key, value in (rest or {}).items():
            setattr(sensor, key, value)

    return Effect(physics, form, "sensor", name, numbers, conceal, limits)


SENSOR_EFFECTS: dict[str, Maker] = {
    maker.__name__: maker for maker in (clock_offset, gain_error, bias, misalignment, mounting_resonance, saturation)
}
