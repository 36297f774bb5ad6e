"""A sensor distorts what it feels: it clips, it rings on its mounting, it is tilted."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve
from scipy.constants import g

from crashkit.model import Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.accused import Accused, accused, fault
from crashkit_hypotheses.build import grid
from crashkit_hypotheses.ringing import HIGHEST, LOWEST, ringing_frequencies
from crashkit_hypotheses.rotation import ERRORS, TURNS, longest, rocking

UNCLIPPED = 1e4
"""Limit, in largest readings, that no motion reaches, and towards which none bends."""
LEANS, STEEPEST = (-0.3, 0.3), 1.2
"""Angles of a sensor that leans towards gravity, rad: to start from, and at most."""
LEANING = {"lean": Parameter(0.0, -STEEPEST, STEEPEST), "bias": Parameter(0.0, -2.0 * g, 2.0 * g)}
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
            self._clipped(model, one, form, error)
            for form, error in LIMITS.items()
            for one in accused(model, recordings, [error])
            if one.largest > 0.0
        ]

    def _clipped(self, model: Model, one: Accused, form: str, error: str) -> Proposal:
        never = UNCLIPPED * one.largest
        limit = {error: Parameter(one.largest, 0.3 * one.largest, never)} | (KNEE if form == "knee" else {})
        starts = grid(**{error: (0.93 * one.largest,)})
        return evolve(fault(self.physics, form, model, one, limit, error, starts, never), refined=form == "knee")


class MountingResonance(Hypothesis):
    """recorded = true + share (q + 2 zeta q' / w - true), q'' + 2 zeta w q' + w^2 q = w^2 true, w = 2 pi frequency.

    That is of a mount; of a sensing element it is true + share (q - true).
    """

    physics: ClassVar[str] = "mounting_resonance"
    sentence: ClassVar[str] = "{place} rings on its mounting"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor that can ring, at the frequencies at which its readings differ most from the motion."""
        errors = ["resonance_share", "resonance_frequency", "resonance_damping"]
        sensors = accused(model, recordings, errors)
        return [form for one in sensors for form in self._forms(model, one, ringing_frequencies(one, motion, recordings))]

    def _forms(self, model: Model, one: Accused, frequencies: Sequence[float]) -> list[Proposal]:
        mount = {
            "resonance_share": Parameter(0.0, 0.0, 1.0),
            "resonance_frequency": Parameter(frequencies[0], 0.5 * LOWEST, 2.0 * HIGHEST),
            "resonance_damping": Parameter(0.05, 5e-3, 0.7),
        }
        starts = grid(resonance_frequency=frequencies)
        forms = {"oscillator": mount}
        if "resonance_path" in one.null:
            # One that is damped more does not ring: it delays, as a clock that is late does in one number.
            element = {"resonance_damping": Parameter(0.05, 5e-3, 0.3), "resonance_path": Parameter(0.0, fixed=True)}
            forms["element"] = mount | element
        return [fault(self.physics, form, model, one, own, "resonance_share", starts) for form, own in forms.items()]


class Misalignment(Hypothesis):
    """recorded = R(tilt) e . true, or (e + transverse) . true, for a channel along e.

    On a line, recorded = cos(lean) true + g sin(lean) + b. The offset b is 0 where gravity was not balanced out before the
    shock. Where all of it was, this is a gain below 1, as `GainError` says. Where the body also moves along the other axis,
    swinging as it is braked, the sensor reads a share of that (see `Rotation`) which no film of the body shows.
    """

    physics: ClassVar[str] = "misalignment"
    sentence: ClassVar[str] = "the axes of {place} are not where they are said to be"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor with several axes: tilted, and with transverse sensitivity; on a line, those that can lean."""
        if len(model.axes) == 1:
            sensors = accused(model, recordings, ["lean", "bias", *ERRORS])
            heaving = [self._heaving(model, one, longest(motion)) for one in sensors] if motion else []
            return [*(self._leaning(model, one) for one in sensors), *heaving]
        tilts = [f"tilt_{axis}" for axis in _turning_axes(model)]
        shares = [f"transverse_{axis}" for axis in model.axes]
        return [
            fault(self.physics, form, model, one, dict.fromkeys(errors, Parameter(0.0, -0.5, 0.5)), errors[0])
            for form, errors in (("tilt", tilts), ("transverse", shares))
            for one in accused(model, recordings, errors)
            if len(one.axes) > 1
        ]

    def _leaning(self, model: Model, one: Accused) -> Proposal:
        return fault(self.physics, "lean", model, one, LEANING, "lean", grid(lean=LEANS))

    def _heaving(self, model: Model, one: Accused, duration: float) -> Proposal:
        errors = rocking(duration) | LEANING
        starts = grid(rocking_frequency=[turns / duration for turns in TURNS])
        return fault(self.physics, "lean, heaving", model, one, errors, "rocking_share", starts)


def _turning_axes(model: Model) -> tuple[str, ...]:
    """The axes about which the model's can turn into each other."""
    return model.axes if len(model.axes) == 3 else tuple(axis for axis in "xyz" if axis not in model.axes)
