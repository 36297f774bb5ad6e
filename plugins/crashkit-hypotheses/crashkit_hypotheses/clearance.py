"""A joint engages only after a gap."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import changed, grid, largest_deformation


class Clearance(Hypothesis):
    """F(d) becomes F(d - gap), and 0 while d < gap."""

    physics: ClassVar[str] = "clearance"
    sentence: ClassVar[str] = "{place} engages only after a gap"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law has a clearance that is not identified already."""
        closed = [joint for joint in model.joints if _is_closed(joint)]
        return [self._gap(model, joint, largest_deformation(motion, joint.name)) for joint in closed]

    def _gap(self, model: Model, joint: Joint, reached: float) -> Proposal:
        gap = {"clearance": Parameter(0.0, 0.0, max(reached, 0.01))}
        starts = [{}, *grid(clearance=[share * max(reached, 0.01) for share in (0.05, 0.2)])]
        return changed(model, joint, self.physics, "gap", gap, "clearance", starts)


def _is_closed(joint: Joint) -> bool:
    gap = joint.parameters.get("clearance")
    return isinstance(gap, Parameter) and gap.fixed and gap.value == 0.0
