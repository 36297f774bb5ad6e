"""Viscoelastic memory: part of a joint's force decays with time."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import grid, largest_deformation, largest_force, multiplied, parallel

TIME_SHARES = (0.05, 0.3)
"""Relaxation times to start from, in durations of a run: shorter ones are dashpots, longer ones springs."""

TRACE = 1e-3
"""Stiffness to start from, relative to the joint's own: at 0 the element's force is on its corner, and has no slope."""


class Relaxation(Hypothesis):
    """F = F_law + k (d - q), q' = (d - q) / tau (Maxwell), or F = F_law (1 - s m), m' = (1 - m) / tau under load."""

    physics: ClassVar[str] = "relaxation"
    sentence: ClassVar[str] = "part of the force of {place} decays with time"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A Maxwell element beside every joint that is compressed, and a share of its own force that fades."""
        used = [joint for joint in model.joints if largest_deformation(motion, joint.name) > 0]
        return [form for joint in used for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        duration = max(float(one["time"].values[-1]) for one in motion)
        trace = TRACE * largest_force(motion, joint.name) / largest_deformation(motion, joint.name)
        time = Parameter(TIME_SHARES[0] * duration, 1e-3, 10.0 * duration)
        times = [share * duration for share in TIME_SHARES]
        element = {
            "relaxing_stiffness": Parameter(0.0, 0.0, 1e9),
            "relaxation_time": time,
            "clearance": Parameter(0.0, fixed=True),
            "tension": Parameter(0.0, fixed=True),
        }
        traces = grid(relaxing_stiffness=(trace,), relaxation_time=times)
        maxwell = [
            parallel(
                model,
                joint,
                self.physics,
                form,
                "maxwell",
                {**element, "holds": Parameter(holds, fixed=True)},
                "relaxing_stiffness",
                traces,
            )
            for form, holds in (("maxwell", 0.0), ("maxwell, holding", 1.0))
        ]
        if "fading" in joint.factors:
            return maxwell
        fading = {"fading_share": Parameter(0.0, 0.0, 1.0), "relaxation_time": time}
        return [
            *maxwell,
            multiplied(model, joint, self.physics, "fading", "fading", fading, "fading_share", grid(relaxation_time=times)),
        ]
