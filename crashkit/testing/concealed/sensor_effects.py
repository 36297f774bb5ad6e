"""Secrets of an instrument: faults that no structure can cause."""

from collections.abc import Callable, Mapping

import numpy as np

from crashkit.testing.concealed.effect import Answer, Effect, Stage
from crashkit.testing.concealed.vehicle import Scene


def clock_offset(stage: Stage) -> Effect:
    """An instrument's clock is ahead or behind."""
    name = stage.one_of(list(stage.scene.instruments))
    offset = stage.rng.uniform(1e-3, 4e-3)
    form = stage.one_of(("ahead", "behind"))

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        scene.instruments[name].clock_offset = numbers["clock_offset"]

    fields = {"clock_offset": offset if form == "behind" else -offset}
    return Effect("clock_offset", form, "instrument", name, fields, change, ("clock_offset",), (0.03, 2.0))


def gain_error(stage: Stage) -> Effect:
    """A sensor reads too much or too little; a wall that stops one body cannot be told from that body's mass."""
    group, sensor, form = *_channel(stage), stage.one_of(("high", "low"))
    fields = {"gain_error": 0.15 if form == "high" else -0.15}

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        scene.instruments[group].sensors[sensor].gain = 1.0 + numbers["gain_error"]

    alone = group == "wall" and len(stage.scene.bodies) == 1
    rivals: tuple[Answer, ...] = (("added_mass", "body", stage.scene.bodies[0]),) if alone else ()
    return Effect("gain_error", form, "sensor", sensor, fields, change, ("gain_error",), (0.1, 2.5), rivals)


def bias(stage: Stage) -> Effect:
    """A sensor's zero is off, for good or drifting away."""
    group, sensor, form = *_channel(stage), stage.one_of(("constant", "constant", "drift"))
    size = float(stage.rng.choice([-0.05, 0.05])) * _peak(stage, group, sensor)
    fields = {"bias": size} if form == "constant" else {"drift": size / stage.scene.duration}
    return _in_sensor("bias", form, group, sensor, fields, next(iter(fields)), (0.02, 5.0))


def mounting_resonance(stage: Stage) -> Effect:
    """A sensor rings on its mounting, all of it or on a part of its path."""
    group, sensor, form = (
        "accelerometer",
        stage.one_of(list(stage.scene.instruments["accelerometer"].sensors)),
        stage.one_of(("mounting", "bracket")),
    )
    fields = {
        "ring_share": 1.0 if form == "mounting" else 0.4,
        "ring_frequency": stage.rng.uniform(100.0, 800.0),
        "ring_damping": stage.rng.uniform(0.01, 0.05) if form == "mounting" else stage.rng.uniform(0.02, 0.1),
    }
    return _in_sensor("mounting_resonance", form, group, sensor, fields, "ring_share", (0.05, 1.0))


def saturation(stage: Stage) -> Effect:
    """A sensor clips, hard or bending towards its limit; strength brings the limit down."""
    group, sensor, form = *_channel(stage), stage.one_of(("hard", "soft"))
    peak = _peak(stage, group, sensor)

    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        scene.instruments[group].sensors[sensor].limit = peak * (1.0 - numbers["lost_share_of_peak"])
        scene.instruments[group].sensors[sensor].soft = form == "soft"

    fields = {"lost_share_of_peak": 0.3}
    return Effect("saturation", form, "sensor", sensor, fields, change, ("lost_share_of_peak",), (0.05, 2.5))


def _channel(stage: Stage) -> tuple[str, str]:
    """A random accelerometer or load cell: its group and name."""
    channels = [(group, name) for group, it in stage.scene.instruments.items() if group != "film" for name in it.sensors]
    return channels[stage.rng.integers(len(channels))]


def _peak(stage: Stage, group: str, sensor: str) -> float:
    """Largest true value in the fastest calibration run, in the channel's unit."""
    trace, body = stage.traces[2], stage.scene.instruments[group].sensors[sensor].body
    return float(np.abs((trace.contact if group == "wall" else trace.acceleration)[body]).max())


def _in_sensor(
    physics: str, form: str, group: str, sensor: str, fields: Mapping[str, float], scaled: str, limits: tuple[float, float]
) -> Effect:
    def change(scene: Scene, numbers: Mapping[str, float]) -> None:
        for name, value in numbers.items():
            setattr(scene.instruments[group].sensors[sensor], name, value)

    return Effect(physics, form, "sensor", sensor, fields, change, (scaled,), limits)


SENSOR_EFFECTS: dict[str, Callable[[Stage], Effect | None]] = {
    effect.__name__: effect for effect in (clock_offset, gain_error, bias, mounting_resonance, saturation)
}
