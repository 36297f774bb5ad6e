"""A body turns about an axis that the model leaves out."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Model, Parameter
from crashkit.model.edit import with_instrument_error
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.accused import Accused, accused

TURNS = (0.2, 0.7, 2.0)
"""How often a body rocks in a run, to start from."""
FEWEST, MOST = 0.1, 10.0
"""The same, that is believed. A car pitches on its suspension at 1 to 2 Hz: a quarter of a turn in a crash."""
ERRORS = ("rocking_share", "rocking_frequency", "rocking_damping")


class Rotation(Hypothesis):
    """Every sensor on a body reads x + s w, w'' + 2 zeta (2 pi f) w' + (2 pi f)^2 w = -x'': the body pitches as it brakes.

    s is how far a sensor is from the centre of mass across the motion, relative to where the body is held.
    """

    physics: ClassVar[str] = "rotation"
    sentence: ClassVar[str] = "{place} turns, which the axes of the model leave out"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every body that moves and carries sensors, if the model is on a line: in the plane bodies turn."""
        if len(model.axes) > 1:
            return []
        duration = longest(motion)
        sensors = accused(model, recordings, ERRORS)
        moving = [body.name for body in model.bodies if not body.fixed]
        riders = {name: [one for one in sensors if one.body == name] for name in moving}
        return [self._rocking(model, name, own, duration) for name, own in riders.items() if own]

    def _rocking(self, model: Model, name: str, sensors: Sequence[Accused], duration: float) -> Proposal:
        shape = rocking(duration)
        share = shape.pop("rocking_share")
        paths = [f"{one.prefix}rocking_share" for one in sensors]
        for one in sensors:
            model = with_instrument_error(model, one.instrument, one.sensor, "rocking_share", share)
        oscillators = dict.fromkeys(_oscillator(model, one, sensors) for one in sensors)
        for instrument, sensor in oscillators:
            for error, parameter in shape.items():
                model = with_instrument_error(model, instrument, sensor, error, parameter)
        shapes = {error: [f"instrument.{'.'.join(one)}.{error}" for one in oscillators] for error in shape}
        return Proposal(
            self.physics,
            "rocking",
            {"body": name},
            model,
            (*paths, *(path for error in shape for path in shapes[error])),
            dict.fromkeys(paths, 0.0),
            tuple(dict.fromkeys(shapes["rocking_frequency"], turns / duration) for turns in TURNS),
        )


def _oscillator(model: Model, one: Accused, sensors: Sequence[Accused]) -> tuple[str, str]:
    """Whose frequency and damping a sensor has: those of its instrument, if several of that ride on the body."""
    several = sum(other.instrument == one.instrument for other in sensors) > 1
    taken = f"instrument.{one.instrument}..rocking_frequency" in model.parameters()
    return one.instrument, "" if several and not taken else one.sensor


def rocking(duration: float) -> dict[str, Parameter]:
    """What a sensor reads of a movement that no axis of the model has, in runs of this length, s."""
    return {
        "rocking_share": Parameter(0.0, -2.0, 2.0),
        "rocking_frequency": Parameter(1.0 / duration, FEWEST / duration, MOST / duration),
        "rocking_damping": Parameter(0.3, 0.01, 0.95),
    }


def longest(motion: Sequence[xr.Dataset]) -> float:
    """s, of these runs."""
    return max(float(run["time"].values[-1]) for run in motion)
