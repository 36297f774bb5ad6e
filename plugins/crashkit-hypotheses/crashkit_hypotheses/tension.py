"""A joint that was taken to push only also pulls."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import changed, grid, largest_deformation, largest_extension, parallel

STRETCHED = 1e-4
"""m."""


class Tension(Hypothesis):
    """The joint's own lines go on below F = 0, or F = F_law + k min(0, d + slack)."""

    physics: ClassVar[str] = "tension"
    sentence: ClassVar[str] = "{place} also pulls"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Its own line at every joint that is compressed or stretched, a strap at every joint that is stretched."""
        proposals = []
        for joint in model.joints:
            stretch = largest_extension(motion, joint.name)
            if _only_pushes(joint) and max(stretch, largest_deformation(motion, joint.name)) > 0.0:
                pull = {"tension": Parameter(0.0, 0.0, 1.0)}
                proposals.append(changed(model, joint, self.physics, "own line", pull, "tension"))
            if stretch > STRETCHED:
                proposals.append(self._strap(model, joint, stretch))
        return proposals

    def _strap(self, model: Model, joint: Joint, stretch: float) -> Proposal:
        strap = {"stiffness": Parameter(0.0, 0.0, 1e9), "slack": Parameter(0.0, 0.0, stretch)}
        starts = grid(slack=(0.0, 0.2 * stretch, 0.5 * stretch))
        return parallel(model, joint, self.physics, "strap", "tension_spring", strap, "stiffness", starts)


def _only_pushes(joint: Joint) -> bool:
    own = joint.parameters.get("tension")
    return isinstance(own, Parameter) and own.value == 0.0
