"""Which sensors the recordings hold, what can be wrong with them, and how a model looks that says so."""

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
class Accused:
    """A sensor, or (`sensor` empty) a whole instrument, that can have some errors.

    Attributes:
        instrument, sensor: names.
        axes: of the instrument.
        null: of each error.
        largest: reading, over all recordings.
        body: that carries the sensor; empty for an instrument.
        axis: the only one of its channels that is accused; empty: all.
    """

    instrument: str
    sensor: str
    axes: tuple[str, ...]
    null: Mapping[str, float]
    largest: float
    body: str = ""
    axis: str = ""

    @property
    def channels(self) -> str:
        """As a model names what has the errors."""
        return f"{self.sensor}/{self.axis}" if self.axis else self.sensor

    @property
    def prefix(self) -> str:
        """Of the paths of its errors."""
        return f"instrument.{self.instrument}.{self.channels}."

    @property
    def place(self) -> dict[str, object]:
        """As a location."""
        return {"sensor": self.sensor, "instrument": self.instrument} if self.sensor else {"instrument": self.instrument}


def accused(model: Model, recordings: Sequence[xr.DataTree], errors: Sequence[str]) -> list[Accused]:
    """Every sensor (or instrument) whose Observer knows these errors, and none of which is identified already."""
    known = model.parameters()
    largest: dict[str, Accused] = {}
    for one in (one for recording in recordings for one in _of_recording(recording, errors)):
        before = largest.get(one.prefix)
        if (before is None or before.largest < one.largest) and not any(one.prefix + name in known for name in errors):
            largest[one.prefix] = one
    return list(largest.values())


def each_channel(
    physics: str, form: str, model: Model, one: Accused, parameters: Mapping[str, Parameter], amplitude: str
) -> list[Proposal]:
    """These errors of all channels of a sensor, and where it has several, of each alone."""
    alone = [evolve(one, axis=axis) for axis in one.axes] if len(one.axes) > 1 else []
    whole = fault(physics, form, model, one, parameters, amplitude)
    return [whole, *(fault(physics, f"{form}, {its.axis} only", model, its, parameters, amplitude) for its in alone)]


def fault(
    physics: str,
    form: str,
    model: Model,
    one: Accused,
    parameters: Mapping[str, Parameter],
    amplitude: str,
    starts: Sequence[Mapping[str, float]] = ({},),
    null: float | None = None,
) -> Proposal:
    """The model with these errors of a sensor; without the first of them the sensor is right."""
    for name, parameter in parameters.items():
        model = with_instrument_error(model, one.instrument, one.channels, name, parameter)
    absent = one.null[amplitude] if null is None else null
    return proposal(model, one.place, one.prefix, Effect(physics, form, "", parameters, amplitude, starts, absent))


def _of_recording(recording: xr.DataTree, errors: Sequence[str]) -> Iterator[Accused]:
    observers = load().observers
    for name, group in recording.children.items():
        observer = observers.get(str(group.attrs.get("observer")))
        null = {spec.name: spec.null for spec in observer.errors if spec.null is not None} if observer else {}
        if observer is None or not set(errors) <= set(null):
            continue
        instrument = group.to_dataset(inherit=False)
        axes = tuple(instrument["axis"].values.tolist()) if "axis" in instrument.coords else ()
        if errors[0] in observer.instrument_errors:
            yield Accused(name, "", axes, null, 0.0)
        else:
            bodies = instrument[f"{observer.channel}_body"].values.tolist()
            peaks = _largest(observer, instrument).items()
            yield from (Accused(name, s, axes, null, peak, body) for (s, peak), body in zip(peaks, bodies, strict=True))


def _largest(observer: type[Observer], instrument: xr.Dataset) -> dict[str, float]:
    """The largest reading of each sensor."""
    readings = np.abs(instrument[observer.quantity].transpose(observer.channel, ...).values)
    names = instrument[observer.channel].values
    return {str(name): float(np.nanmax(channel)) for name, channel in zip(names, readings, strict=True)}
