"""An instrument is wrong by a number: its sensitivity, its offset, its clock."""

from collections.abc import Mapping, Sequence
from typing import ClassVar, TypeAlias

import xarray as xr
from attrs import evolve

from crashkit.model import Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.accused import Accused, accused, each_channel, fault
from crashkit_hypotheses.build import grid

Fault: TypeAlias = tuple[dict[str, Parameter], str, Sequence[Mapping[str, float]]]
"""The errors of a sensor, the one without which it is right, and where to start."""

GAIN = Parameter(1.0, 0.2, 5.0)
STEEPEST_FALL, STEEPEST = -1.0 / 3.0, 0.5
"""Of a cubic term over the square of the largest reading, and of a quadratic one over that reading: with more, larger readings
would be smaller ones."""
SHIFT = ("zero_shift", "zero_shift_time", "zero_shift_rise")
MOMENTS = (0.1, 0.3, 0.6)
"""Shares of the time recorded at which the zero may shift, to start from."""
SLOW, SLOWEST = 0.03, 0.1
"""Shares of it that a shift takes, at first and at most."""


class GainError(Hypothesis):
    """recorded = g true, g other than 1; g true + c (g true)^3, c above 0 or below: with g = 1 that saturates; or g true +
    q (g true)^2, which is more on one side than on the other.

    Along one axis a sensor that is tilted by an angle reads cos(angle) of the truth, and gravity, if that is not balanced out:
    else no recording of that axis alone tells the two apart.
    """

    physics: ClassVar[str] = "gain_error"
    sentence: ClassVar[str] = (
        "the sensitivity of {place} is wrong (or, where it reads too little along one axis, it is tilted)"
    )
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor, from a fifth to five times the stated sensitivity; one that rises or falls with the reading, where the
        Observer knows of it."""
        constant = [
            proposal
            for one in accused(model, recordings, ["gain"])
            for proposal in each_channel(self.physics, "constant", model, one, {"gain": GAIN}, "gain")
        ]
        bent = [one for one in accused(model, recordings, ["gain", "cubic"]) if one.largest > 0.0]
        rising = [self._bent(model, one, "rising", "cubic", 0.0, 1.0 / one.largest**2) for one in bent]
        falling = [self._bent(model, one, "falling", "cubic", STEEPEST_FALL / one.largest**2, 0.0) for one in bent]
        uneven = [
            self._bent(model, one, "uneven", "quadratic", -STEEPEST / one.largest, STEEPEST / one.largest)
            for one in accused(model, recordings, ["gain", "quadratic"])
            if one.largest > 0.0
        ]
        return [*constant, *rising, *(evolve(form, refined=True) for form in (*falling, *uneven))]

    def _bent(self, model: Model, one: Accused, form: str, error: str, lowest: float, highest: float) -> Proposal:
        return fault(self.physics, form, model, one, {"gain": GAIN, error: Parameter(0.0, lowest, highest)}, "gain")


class Bias(Hypothesis):
    """recorded = true + b, true + b + b' t, or true + b where the shock shifts the zero."""

    physics: ClassVar[str] = "bias"
    sentence: ClassVar[str] = "{place} has an offset"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor; an offset that drifts, or comes with the shock, where the Observer knows of one."""
        duration = max(float(run["time"].values[-1]) for run in motion)
        constant = [
            proposal
            for one in accused(model, recordings, ["bias"])
            for proposal in each_channel(self.physics, "constant", model, one, {"bias": _within(one.largest)}, "bias")
        ]
        forms = {"drift": (_drift, ["bias_drift", "bias"]), "shift": (_shift, list(SHIFT))}
        changing = [
            fault(self.physics, form, model, one, *changed(one.largest, duration))
            for form, (changed, errors) in forms.items()
            for one in accused(model, recordings, errors)
        ]
        return [*constant, *changing]


def _drift(largest: float, duration: float) -> Fault:
    return {"bias_drift": _within(largest / duration), "bias": _within(largest)}, "bias_drift", ({},)


def _shift(largest: float, duration: float) -> Fault:
    """A step at some time, at first a slow one, from which its time is seen."""
    rise = Parameter(SLOW * duration, SLOWEST * duration / 1000.0, SLOWEST * duration)
    errors = dict(zip(SHIFT, (_within(largest), Parameter(0.0, -duration, duration), rise), strict=True))
    return errors, "zero_shift", grid(zero_shift_time=[share * duration for share in MOMENTS])


class ClockOffset(Hypothesis):
    """recorded(t) = true(t - tau), or true(t (1 - r) - tau): a clock that is late, or gets later."""

    physics: ClassVar[str] = "clock_offset"
    sentence: ClassVar[str] = "the clock of {place} is shifted against the others"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every instrument, within 20 ms; one whose clock runs fast or slow, where the Observer knows of it."""
        offset, rate = Parameter(0.0, -0.02, 0.02), Parameter(0.0, -0.05, 0.05)
        forms = {"constant": {"clock_offset": offset}, "drift": {"clock_offset": offset, "clock_rate": rate}}
        return [
            evolve(fault(self.physics, form, model, one, clock, "clock_offset"), refined=form == "drift")
            for form, clock in forms.items()
            for one in accused(model, recordings, list(clock))
        ]


def _within(largest: float) -> Parameter:
    """No larger than the largest reading."""
    return Parameter(0.0, -largest, largest)
