"""A sensor distorts what it feels: it clips, it rings on its mounting, it is tilted."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve
from scipy.constants import g

from crashkit.model import Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, grid
from crashkit_hypotheses.crossing import lean_across
from crashkit_hypotheses.ringing import HIGHEST, LOWEST, ringing_frequencies
from crashkit_hypotheses.rocking import ERRORS, TURNS, rocking
from crashkit_hypotheses.sensors import Sensor, faulty, sensors_with
from crashkit_hypotheses.sizes import duration

UNCLIPPED = 1e4
"""Limit, in largest readings, that no motion reaches, and towards which none bends."""
LEANS, STEEPEST = (-0.3, 0.3), 1.2
"""Angles of a sensor that leans towards gravity, rad: to start from, and at most."""
LEANING = {"lean": Parameter(0.0, -STEEPEST, STEEPEST), "bias": Parameter(0.0, -2.0 * g, 2.0 * g)}
TOLD, TOLD_ODDS = 0.1, 1e4
"""How far such an angle may be off what the other axes of the sensor tell, of that; and the odds of a lean that they tell
against anything else that changes what it reads along its own."""
LIMITS = {
    "limit": "saturation",
    "above": "saturation_above",
    "below": "saturation_below",
    "soft": "saturation_soft",
    "knee": "saturation_knee",
}
"""The errors of a sensor that clips, by form."""
KNEE = {"knee_sharpness": Parameter(8.0, 1.0, 30.0)}
"""Of the last: between the first and the one before it, and so only asked for where these leave something."""


class Saturation(Hypothesis):
    """recorded = min(limit, max(-limit, true)), the same on one side only, limit tanh(true / limit), or with a knee between
    these, true / (1 + (|true| / limit)^n)^(1 / n)."""

    physics: ClassVar[str] = "saturation"
    sentence: ClassVar[str] = "{place} clips its readings"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor that can clip, at about its largest reading: what clips reads no more than its limit and noise."""
        return [
            self._clipped(model, sensor, form, error)
            for form, error in LIMITS.items()
            for sensor in sensors_with([error], model, recordings)
            if sensor.largest > 0.0
        ]

    def _clipped(self, model: Model, sensor: Sensor, form: str, error: str) -> Proposal:
        never = UNCLIPPED * sensor.largest
        limit = {error: Parameter(sensor.largest, 0.3 * sensor.largest, never)} | (KNEE if form == "knee" else {})
        starts = grid(**{error: (0.93 * sensor.largest,)})
        clipped = faulty(model, sensor, Effect(self.physics, form, "", limit, error, starts))
        # The limit's own null, infinity, is no value that a search could pass.
        return evolve(clipped, null=dict.fromkeys(clipped.null, never), refined=form == "knee")


class MountingResonance(Hypothesis):
    """recorded = true + share (q + 2 zeta q' / w - true), q'' + 2 zeta w q' + w^2 q = w^2 true, w = 2 pi frequency.

    That is of a mount; of a sensing element it is true + share (q - true).
    """

    physics: ClassVar[str] = "mounting_resonance"
    sentence: ClassVar[str] = "{place} rings on its mounting"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor that can ring, at the frequencies at which its readings differ most from the motion."""
        sensors = sensors_with(["resonance_share", "resonance_frequency", "resonance_damping"], model, recordings)
        return [
            form for sensor in sensors for form in self._forms(model, sensor, ringing_frequencies(sensor, motion, recordings))
        ]

    def _forms(self, model: Model, sensor: Sensor, frequencies: Sequence[float]) -> list[Proposal]:
        mount = {
            "resonance_share": Parameter(0.0, 0.0, 1.0),
            "resonance_frequency": Parameter(frequencies[0], LOWEST, 2.0 * HIGHEST),
            "resonance_damping": Parameter(0.05, 5e-3, 0.7),
        }
        # One that is damped more does not ring: it delays, as a clock that is late does in one number.
        element = {"resonance_damping": Parameter(0.05, 5e-3, 0.3), "resonance_path": Parameter(0.0, fixed=True)}
        starts = grid(resonance_frequency=frequencies)
        oscillator = Effect(self.physics, "oscillator", "", mount, "resonance_share", starts)
        forms = [oscillator, evolve(oscillator, form="element", parameters=mount | element)]
        known = forms if "resonance_path" in sensor.null else forms[:1]
        return [faulty(model, sensor, form) for form in known]


class Misalignment(Hypothesis):
    """recorded = R(tilt) e . true, or (e + transverse) . true, for a channel along e.

    On a line, recorded = cos(lean) true + g sin(lean) + b. The offset b is 0 where gravity was not balanced out before the
    shock. Where all of it was, this is a gain below 1, as `GainError` says, unless the sensor has other axes, which read
    sin(lean) true: the model says nothing of those, but what they share with the first tells the angle. Where the body also
    moves along the other axis, swinging as it is braked, the sensor reads a share of that (see `Rotation`) which no film of
    the body shows.
    """

    physics: ClassVar[str] = "misalignment"
    sentence: ClassVar[str] = "the axes of {place} are not where they are said to be"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor with several axes: tilted, and with transverse sensitivity; on a line, those that can lean."""
        if len(model.axes) == 1:
            sensors = sensors_with(["lean", "bias", *ERRORS], model, recordings)
            heaving = [self._heaving(model, sensor, duration(motion)) for sensor in sensors] if motion else []
            told = [(sensor, lean_across(sensor, model.axes[0], recordings)) for sensor in sensors]
            across = [self._leaning_across(model, sensor, angle) for sensor, angle in told if 0.0 < angle < STEEPEST]
            return [*(self._leaning(model, sensor) for sensor in sensors), *across, *heaving]
        tilts = [f"tilt_{axis}" for axis in _turning_axes(model)]
        shares = [f"transverse_{axis}" for axis in model.axes]
        return [*self._tilted(model, recordings, "tilt", tilts), *self._tilted(model, recordings, "transverse", shares)]

    def _leaning(self, model: Model, sensor: Sensor) -> Proposal:
        return faulty(model, sensor, Effect(self.physics, "lean", "", LEANING, "lean", grid(lean=LEANS)))

    def _leaning_across(self, model: Model, sensor: Sensor, angle: float) -> Proposal:
        lean = Parameter(angle, (1.0 - TOLD) * angle, min((1.0 + TOLD) * angle, STEEPEST))
        starts = grid(lean=(lean.value,), bias=(0.0, -g * float(np.sin(angle))))
        effect = Effect(self.physics, "lean, told across", "", LEANING | {"lean": lean}, "lean", starts)
        return evolve(faulty(model, sensor, effect), null={}, odds=TOLD_ODDS)

    def _heaving(self, model: Model, sensor: Sensor, longest: float) -> Proposal:
        errors = rocking(longest) | LEANING
        starts = grid(rocking_frequency=[turns / longest for turns in TURNS])
        return faulty(model, sensor, Effect(self.physics, "lean, heaving", "", errors, "rocking_share", starts))

    def _tilted(self, model: Model, recordings: Sequence[xr.DataTree], form: str, errors: Sequence[str]) -> list[Proposal]:
        tilt = Effect(self.physics, form, "", dict.fromkeys(errors, Parameter(0.0, -0.5, 0.5)), errors[0])
        sensors = sensors_with(errors, model, recordings)
        return [faulty(model, sensor, tilt) for sensor in sensors if len(sensor.axes) > 1]


def _turning_axes(model: Model) -> tuple[str, ...]:
    """The axes about which the model's can turn into each other."""
    return model.axes if len(model.axes) == 3 else tuple(axis for axis in "xyz" if axis not in model.axes)
