"""A body turns about an axis that the model leaves out."""

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Body, KnownSum, Model, Parameter
from crashkit.model.edit import with_instrument_error
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.carried_load import swinging_load
from crashkit_hypotheses.rocking import ERRORS, TURNS, rocking
from crashkit_hypotheses.sensors import Sensor, sensors_with
from crashkit_hypotheses.sizes import braked_axis, duration

LEAST = 0.3
"""Of the mass of a body, how much of it moves at once where it is held, at least."""
WEIGHED = 1e-3
"""Of that mass, how well it is kept: what else acts beside the turning makes up for nothing by it."""
SHARES = (0.05, 0.2)
"""Of the mass of a body, that its turning takes off where it is held, to start from."""
DAMPING = 0.3
"""Of a turning, of critical, to start from."""


class Rotation(Hypothesis):
    """Every sensor on a body reads x + s w, w'' + 2 zeta (2 pi f) w' + (2 pi f)^2 w = -x'': the body turns as it brakes.

    s is how far a sensor is from the centre of mass across the motion, relative to where the body is held. On a line it
    pitches or yaws; in the plane it turns about an axis that lies in the plane, and x is along the axis on which it brakes.
    Held off its centre of mass, it also gives way there as a lighter body does that carries the rest of it on a spring.
    """

    physics: ClassVar[str] = "rotation"
    sentence: ClassVar[str] = "{place} turns, which the axes of the model leave out"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every body that moves and carries sensors, except in space, where bodies turn about every axis; held at its centre
        of mass, or off that if forces move it and it is no load."""
        if len(model.axes) == 3:
            return []
        known = model.parameters()
        sensors = [_along(model, sensor, motion) for sensor in sensors_with(ERRORS, model, recordings)]
        new = [sensor for sensor in sensors if sensor.axis in ("", *sensor.axes) and sensor.prefix + ERRORS[0] not in known]
        riders = [(body, [sensor for sensor in new if sensor.body == body.name]) for body in model.bodies if not body.fixed]
        seen = [(body, own) for body, own in riders if own]
        held = [(body, own) for body, own in seen if body.is_free and not body.carrier]
        return [
            *(self._rocking(model, body.name, own, duration(motion)) for body, own in seen),
            *(self._acting_back(model, body, own, motion) for body, own in held),
        ]

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

    def _acting_back(self, model: Model, body: Body, sensors: Sequence[Sensor], motion: Sequence[xr.Dataset]) -> Proposal:
        """A force F at the distance a from the centre of mass of a body of mass m and inertia I, held by k, moves its own
        point by F / (m s^2) + a^2 F / (I s^2 + k), as if it moved a mass m / (1 + m a^2 / I) that carries the rest of m on a
        spring. On it that swings at sqrt(k / (I + m a^2)), as often as the body turns."""
        path = f"body.{body.name}.mass"
        mass = model.parameters()[path]
        lighter = {path: Parameter(mass.value, LEAST * mass.value, mass.value)} if mass.fixed else {}
        load = swinging_load(model.with_parameters(lighter), body, mass.value, motion)
        together = KnownSum((path, load.parameters[0]), mass.value, WEIGHED * mass.value)
        parted = evolve(load.model, sums=(*model.sums, together)) if mass.fixed else load.model
        longest = duration(motion)
        turning = self._rocking(parted, body.name, sensors, longest)
        starts = [
            {**start, **_parted(load, share * mass.value, turns / longest), **_lighter(lighter, share)}
            for turns, start in zip(TURNS, turning.starts, strict=True)
            for share in SHARES
        ]
        paths = (*turning.parameters, *lighter, *load.parameters)
        return evolve(turning, form="rocking, acting back", parameters=paths, null={}, starts=tuple(starts))


def _lighter(mass: Mapping[str, Parameter], share: float) -> dict[str, float]:
    """Where the mass of a body starts that lacks this share of it."""
    return {path: (1.0 - share) * whole.value for path, whole in mass.items()}


def _parted(load: Proposal, mass: float, frequency: float) -> dict[str, float]:
    """Where the numbers of a load of this mass start that swings at this frequency, s-1, or as near to it as they may."""
    rate, known = 2.0 * math.pi * frequency, load.model.parameters()
    values = dict(zip(load.parameters, (mass, mass * rate**2, 2.0 * DAMPING * mass * rate), strict=True))
    return {path: min(max(value, known[path].lower), known[path].upper) for path, value in values.items()}


def _along(model: Model, sensor: Sensor, motions: Sequence[xr.Dataset]) -> Sensor:
    """What a sensor reads along the way on which its body brakes."""
    return sensor if len(model.axes) == 1 else evolve(sensor, axis=braked_axis(motions, sensor.body))


def _oscillator(model: Model, sensor: Sensor, sensors: Sequence[Sensor]) -> tuple[str, str]:
    """Whose frequency and damping a sensor has: those of its instrument, if several of that ride on the body."""
    several = sum(other.instrument == sensor.instrument for other in sensors) > 1
    taken = f"instrument.{sensor.instrument}..rocking_frequency" in model.parameters()
    return sensor.instrument, "" if several and not taken else sensor.channels
