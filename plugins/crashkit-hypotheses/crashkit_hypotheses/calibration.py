"""An instrument is wrong by a number: its sensitivity, its offset, its clock."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, grid
from crashkit_hypotheses.sensors import Sensor, faulty, faulty_channels, sensors_with
from crashkit_hypotheses.sizes import duration

GAIN = Parameter(1.0, 0.2, 5.0)
STEEPEST_FALL, STEEPEST = -1.0 / 3.0, 0.5
"""Of a cubic term over the square of the largest reading, and of a quadratic one over that reading: with more, larger readings
would be smaller ones."""
DRIFT = ("bias_drift", "bias")
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
        stated = Effect(self.physics, "constant", "", {"gain": GAIN}, "gain")
        constant = [
            form for sensor in sensors_with(["gain"], model, recordings) for form in faulty_channels(model, sensor, stated)
        ]
        cubic, quadratic = (
            [sensor for sensor in sensors_with(["gain", error], model, recordings) if sensor.largest > 0.0]
            for error in ("cubic", "quadratic")
        )
        rising = [self._rising(model, sensor) for sensor in cubic]
        fine = [*(self._falling(model, sensor) for sensor in cubic), *(self._uneven(model, sensor) for sensor in quadratic)]
        return [*constant, *rising, *(evolve(form, refined=True) for form in fine)]

    def _rising(self, model: Model, sensor: Sensor) -> Proposal:
        return self._bent(model, sensor, "rising", "cubic", Parameter(0.0, 0.0, 1.0 / sensor.largest**2))

    def _falling(self, model: Model, sensor: Sensor) -> Proposal:
        return self._bent(model, sensor, "falling", "cubic", Parameter(0.0, STEEPEST_FALL / sensor.largest**2, 0.0))

    def _uneven(self, model: Model, sensor: Sensor) -> Proposal:
        steepest = STEEPEST / sensor.largest
        return self._bent(model, sensor, "uneven", "quadratic", Parameter(0.0, -steepest, steepest))

    def _bent(self, model: Model, sensor: Sensor, form: str, error: str, bend: Parameter) -> Proposal:
        return faulty(model, sensor, Effect(self.physics, form, "", {"gain": GAIN, error: bend}, "gain"))


class Bias(Hypothesis):
    """recorded = true + b, true + b + b' t, or true + b where the shock shifts the zero."""

    physics: ClassVar[str] = "bias"
    sentence: ClassVar[str] = "{place} has an offset"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor; an offset that drifts, or comes with the shock, where the Observer knows of one."""
        longest = duration(motion)
        return [
            *(form for sensor in sensors_with(["bias"], model, recordings) for form in self._constant(model, sensor)),
            *(self._drift(model, sensor, longest) for sensor in sensors_with(DRIFT, model, recordings)),
            *(self._shift(model, sensor, longest) for sensor in sensors_with(SHIFT, model, recordings)),
        ]

    def _constant(self, model: Model, sensor: Sensor) -> list[Proposal]:
        return faulty_channels(model, sensor, Effect(self.physics, "constant", "", {"bias": _within(sensor.largest)}, "bias"))

    def _drift(self, model: Model, sensor: Sensor, longest: float) -> Proposal:
        drift = {"bias_drift": _within(sensor.largest / longest), "bias": _within(sensor.largest)}
        return faulty(model, sensor, Effect(self.physics, "drift", "", drift, "bias_drift"))

    def _shift(self, model: Model, sensor: Sensor, longest: float) -> Proposal:
        """A step at some time, at first a slow one, from which its time is seen."""
        rise = Parameter(SLOW * longest, SLOWEST * longest / 1000.0, SLOWEST * longest)
        step = dict(zip(SHIFT, (_within(sensor.largest), _within(longest), rise), strict=True))
        starts = grid(zero_shift_time=[share * longest for share in MOMENTS])
        return faulty(model, sensor, Effect(self.physics, "shift", "", step, "zero_shift", starts))


class ClockOffset(Hypothesis):
    """recorded(t) = true(t - tau), or true(t (1 - r) - tau): a clock that is late, or gets later."""

    physics: ClassVar[str] = "clock_offset"
    sentence: ClassVar[str] = "the clock of {place} is shifted against the others"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every instrument, within 20 ms; one whose clock runs fast or slow, where the Observer knows of it."""
        offset, rate = Parameter(0.0, -0.02, 0.02), Parameter(0.0, -0.05, 0.05)
        late = Effect(self.physics, "constant", "", {"clock_offset": offset}, "clock_offset")
        later = evolve(late, form="drift", parameters={"clock_offset": offset, "clock_rate": rate})
        return [
            evolve(faulty(model, instrument, clock), refined=clock is later)
            for clock in (late, later)
            for instrument in sensors_with(list(clock.parameters), model, recordings)
        ]


def _within(largest: float) -> Parameter:
    """No larger than that, either way."""
    return Parameter(0.0, -largest, largest)
