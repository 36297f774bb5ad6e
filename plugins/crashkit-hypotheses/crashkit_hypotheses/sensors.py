"""Which sensors the recordings hold, which errors they can have, and how a model looks with these."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve, frozen

from crashkit.model import Model, Parameter
from crashkit.model.edit import with_instrument_error
from crashkit.protocols import Observer, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import Effect, proposal


@frozen
class Sensor:
    """A sensor, or a whole instrument, that can have some errors.

    Attributes:
        instrument: its name.
        name: of the sensor; empty for a whole instrument.
        axes: of the instrument.
        null: of each error.
        largest: reading, over all recordings.
        body: that carries the sensor; empty for an instrument.
        axis: the only one of its channels that has the errors; empty: all.
    """

    instrument: str
    name: str
    axes: tuple[str, ...]
    null: Mapping[str, float]
    largest: float
    body: str = ""
    axis: str = ""

    @property
    def channels(self) -> str:
        """As a model names what has the errors."""
        return f"{self.name}/{self.axis}" if self.axis else self.name

    @property
    def prefix(self) -> str:
        """Of the paths of its errors."""
        return f"instrument.{self.instrument}.{self.channels}."

    @property
    def place(self) -> dict[str, object]:
        """As a location."""
        return {"sensor": self.name, "instrument": self.instrument} if self.name else {"instrument": self.instrument}


def sensors_with(errors: Sequence[str], model: Model, recordings: Sequence[xr.DataTree]) -> list[Sensor]:
    """Every sensor (or instrument) whose Observer knows these errors, and none of which is identified already."""
    known = model.parameters()
    largest: dict[str, Sensor] = {}
    for sensor in (sensor for recording in recordings for sensor in _of_recording(recording, errors)):
        before = largest.get(sensor.prefix)
        identified = any(sensor.prefix + name in known for name in errors)
        if not identified and (before is None or before.largest < sensor.largest):
            largest[sensor.prefix] = sensor
    return list(largest.values())


def faulty(model: Model, sensor: Sensor, effect: Effect) -> Proposal:
    """The model with errors of a sensor; at the amplitude's null, which its Observer tells, the sensor is right."""
    for name, error in effect.parameters.items():
        if isinstance(error, Parameter):
            model = with_instrument_error(model, sensor.instrument, sensor.channels, name, error)
    return proposal(model, sensor.place, sensor.prefix, evolve(effect, null=sensor.null[effect.amplitude]))


def faulty_channels(model: Model, sensor: Sensor, effect: Effect) -> list[Proposal]:
    """These errors of all channels of a sensor, and where it has several, of each alone."""
    alone = sensor.axes if len(sensor.axes) > 1 else ()
    return [
        faulty(model, sensor, effect),
        *(faulty(model, evolve(sensor, axis=axis), evolve(effect, form=f"{effect.form}, {axis} only")) for axis in alone),
    ]


def _of_recording(recording: xr.DataTree, errors: Sequence[str]) -> Iterator[Sensor]:
    observers = load().observers
    for name, group in recording.children.items():
        observer = observers.get(str(group.attrs.get("observer")))
        null = {spec.name: spec.null for spec in observer.errors if spec.null is not None} if observer else {}
        if observer is None or not set(errors) <= set(null):
            continue
        instrument = group.to_dataset(inherit=False)
        axes = tuple(instrument["axis"].values.tolist()) if "axis" in instrument.coords else ()
        if errors[0] in observer.instrument_errors:
            yield Sensor(name, "", axes, null, 0.0)
        else:
            bodies = instrument[f"{observer.channel}_body"].values.tolist()
            peaks = _largest(observer, instrument).items()
            yield from (Sensor(name, s, axes, null, peak, body) for (s, peak), body in zip(peaks, bodies, strict=True))


def _largest(observer: type[Observer], instrument: xr.Dataset) -> dict[str, float]:
    """The largest reading of each sensor."""
    readings = np.abs(instrument[observer.quantity].transpose(observer.channel, ...).values)
    names = instrument[observer.channel].values
    return {str(name): float(np.nanmax(channel)) for name, channel in zip(names, readings, strict=True)}
