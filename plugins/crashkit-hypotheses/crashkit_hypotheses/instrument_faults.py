"""An instrument is wrong by a number: its sensitivity, its offset, its clock."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.accused import accused, fault


class GainError(Hypothesis):
    """recorded = g x true, g other than 1.

    Along one axis a sensor that is tilted by an angle reads cos(angle) of the truth: no recording of that axis alone tells the
    two apart.
    """

    physics: ClassVar[str] = "gain_error"
    sentence: ClassVar[str] = (
        "the sensitivity of {place} is wrong (or, where it reads too little along one axis, it is tilted)"
    )
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor, from a fifth to five times the stated sensitivity."""
        gain = {"gain": Parameter(1.0, 0.2, 5.0)}
        return [fault(self.physics, "constant", model, one, gain, "gain") for one in accused(model, recordings, ["gain"])]


class Bias(Hypothesis):
    """recorded = true + b, or true + b + b' t."""

    physics: ClassVar[str] = "bias"
    sentence: ClassVar[str] = "{place} has an offset"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every sensor; an offset that drifts where the Observer knows of one."""
        constant = [
            fault(self.physics, "constant", model, one, {"bias": _within(one.largest)}, "bias")
            for one in accused(model, recordings, ["bias"])
        ]
        duration = max(float(run["time"].values[-1]) for run in motion)
        drifting = [
            fault(
                self.physics,
                "drift",
                model,
                one,
                {"bias_drift": _within(one.largest / duration), "bias": _within(one.largest)},
                "bias_drift",
            )
            for one in accused(model, recordings, ["bias_drift", "bias"])
        ]
        return [*constant, *drifting]


class ClockOffset(Hypothesis):
    """recorded(t) = true(t - tau)."""

    physics: ClassVar[str] = "clock_offset"
    sentence: ClassVar[str] = "the clock of {place} is shifted against the others"
    sensor: ClassVar[bool] = True

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every instrument, within 20 ms."""
        offset = {"clock_offset": Parameter(0.0, -0.02, 0.02)}
        return [
            fault(self.physics, "constant", model, one, offset, "clock_offset")
            for one in accused(model, recordings, ["clock_offset"])
        ]


def _within(largest: float) -> Parameter:
    """No larger than the largest reading."""
    return Parameter(0.0, -largest, largest)
