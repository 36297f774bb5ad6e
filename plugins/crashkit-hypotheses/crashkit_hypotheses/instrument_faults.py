"""An instrument is wrong: its sensitivity, its offset, its clock."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.model import Model, Parameter
from crashkit.model.edit import with_instrument_error
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import proposal


@frozen
class Accused:
    """A sensor, or (`sensor` empty) a whole instrument, that can have the error `name`, and its largest reading."""

    instrument: str
    sensor: str
    name: str
    null: float
    largest: float


class InstrumentFault(Hypothesis):
    """One of the error parameters that the recordings' Observers declare."""

    error: ClassVar[str]
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor (or instrument) whose Observer knows this error and that is not identified already."""
        known = model.parameters()
        accused = [a for a in _accused(recordings, self.error) if f"{_prefix(a)}{a.name}" not in known]
        return [self._fault(model, one) for one in accused]

    def bounds(self, largest: float) -> tuple[float, float]:
        """How wrong it may be, given the largest reading."""
        return -largest, largest

    def _fault(self, model: Model, accused: Accused) -> Proposal:
        parameter = Parameter(accused.null, *self.bounds(accused.largest))
        augmented = with_instrument_error(model, accused.instrument, accused.sensor, accused.name, parameter)
        location = {"sensor": accused.sensor, "instrument": accused.instrument}
        place = location if accused.sensor else {"instrument": accused.instrument}
        parameters = {accused.name: parameter}
        return proposal(
            self.physics, "constant", place, augmented, _prefix(accused), parameters, accused.name, ({},), accused.null
        )


class GainError(InstrumentFault):
    """recorded = g x true, g other than 1."""

    physics: ClassVar[str] = "gain_error"
    sentence: ClassVar[str] = "the sensitivity of {place} is wrong"
    error: ClassVar[str] = "gain"

    def bounds(self, largest: float) -> tuple[float, float]:
        """From a fifth to five times the stated sensitivity."""
        return 0.2, 5.0


class Bias(InstrumentFault):
    """recorded = true + b."""

    physics: ClassVar[str] = "bias"
    sentence: ClassVar[str] = "{place} has an offset"
    error: ClassVar[str] = "bias"


class ClockOffset(InstrumentFault):
    """recorded(t) = true(t - tau)."""

    physics: ClassVar[str] = "clock_offset"
    sentence: ClassVar[str] = "the clock of {place} is shifted against the others"
    error: ClassVar[str] = "clock_offset"

    def bounds(self, largest: float) -> tuple[float, float]:
        """Within 20 ms."""
        return -0.02, 0.02


def _prefix(accused: Accused) -> str:
    return f"instrument.{accused.instrument}.{accused.sensor}."


def _accused(recordings: Sequence[xr.DataTree], error: str) -> list[Accused]:
    """Each once, with its largest reading over all recordings."""
    largest: dict[tuple[str, str], Accused] = {}
    for one in (one for recording in recordings for one in _of_recording(recording, error)):
        before = largest.get((one.instrument, one.sensor))
        if before is None or before.largest < one.largest:
            largest[one.instrument, one.sensor] = one
    return list(largest.values())


def _of_recording(recording: xr.DataTree, error: str) -> Iterator[Accused]:
    observers = load().observers
    for name, group in recording.children.items():
        observer = observers.get(str(group.attrs.get("observer")))
        spec = next((spec for spec in observer.errors if spec.name == error), None) if observer else None
        if observer is None or spec is None or spec.null is None:
            continue
        if error in observer.instrument_errors:
            yield Accused(name, "", error, spec.null, 0.0)
            continue
        instrument = group.to_dataset(inherit=False)
        for sensor in instrument[observer.channel].values:
            readings = instrument[observer.quantity].sel({observer.channel: sensor}).values
            yield Accused(name, str(sensor), error, spec.null, float(np.nanmax(np.abs(readings))))
