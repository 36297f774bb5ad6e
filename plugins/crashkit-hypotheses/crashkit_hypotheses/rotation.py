"""A body turns about an axis that the model leaves out."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Model
from crashkit.model.edit import with_instrument_error
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.rocking import ERRORS, TURNS, rocking
from crashkit_hypotheses.sensors import Sensor, sensors_with
from crashkit_hypotheses.sizes import braked_axis, duration


class Rotation(Hypothesis):
    """Every sensor on a body reads x + s w, w'' + 2 zeta (2 pi f) w' + (2 pi f)^2 w = -x'': the body turns as it brakes.

    s is how far a sensor is from the centre of mass across the motion, relative to where the body is held. On a line it
    pitches or yaws; in the plane it turns about an axis that lies in the plane, and x is along the axis on which it brakes.
    """

    physics: ClassVar[str] = "rotation"
    sentence: ClassVar[str] = "{place} turns, which the axes of the model leave out"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every body that moves and carries sensors, except in space, where bodies turn about every axis."""
        if len(model.axes) == 3:
            return []
        longest, known = duration(motion), model.parameters()
        sensors = [_along(model, sensor, motion) for sensor in sensors_with(ERRORS, model, recordings)]
        new = [sensor for sensor in sensors if sensor.axis in ("", *sensor.axes) and sensor.prefix + ERRORS[0] not in known]
        moving = [body.name for body in model.bodies if not body.fixed]
        riders = {name: [sensor for sensor in new if sensor.body == name] for name in moving}
        return [self._rocking(model, name, own, longest) for name, own in riders.items() if own]

    def _rocking(self, model: Model, name: str, sensors: Sequence[Sensor], longest: float) -> Proposal:
        shape = rocking(longest)
        share = shape.pop("rocking_share")
        paths = [f"{sensor.prefix}rocking_share" for sensor in sensors]
        for sensor in sensors:
            model = with_instrument_error(model, sensor.instrument, sensor.channels, "rocking_share", share)
        oscillators = dict.fromkeys(_oscillator(model, sensor, sensors) for sensor in sensors)
        for instrument, own in oscillators:
            for error, parameter in shape.items():
                model = with_instrument_error(model, instrument, own, error, parameter)
        shapes = {error: [f"instrument.{'.'.join(one)}.{error}" for one in oscillators] for error in shape}
        return Proposal(
            self.physics,
            "rocking",
            {"body": name},
            model,
            (*paths, *(path for error in shape for path in shapes[error])),
            dict.fromkeys(paths, 0.0),
            tuple(dict.fromkeys(shapes["rocking_frequency"], turns / longest) for turns in TURNS),
        )


def _along(model: Model, sensor: Sensor, motions: Sequence[xr.Dataset]) -> Sensor:
    """What a sensor reads along the way on which its body brakes."""
    return sensor if len(model.axes) == 1 else evolve(sensor, axis=braked_axis(motions, sensor.body))


def _oscillator(model: Model, sensor: Sensor, sensors: Sequence[Sensor]) -> tuple[str, str]:
    """Whose frequency and damping a sensor has: those of its instrument, if several of that ride on the body."""
    several = sum(other.instrument == sensor.instrument for other in sensors) > 1
    taken = f"instrument.{sensor.instrument}..rocking_frequency" in model.parameters()
    return sensor.instrument, "" if several and not taken else sensor.channels
