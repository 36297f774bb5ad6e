"""A joint engages only after a gap."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, changed, grid
from crashkit_hypotheses.sizes import largest_deformation


class Clearance(Hypothesis):
    """F(d) becomes F(d - gap), and 0 while d < gap; or it engages softly after the gap."""

    physics: ClassVar[str] = "clearance"
    sentence: ClassVar[str] = "{place} engages only after a gap"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law has a clearance that is not identified already."""
        closed = [joint for joint in model.joints if _is_closed(joint)]
        forms = (self._gap, self._toe)
        return [form(model, joint, max(largest_deformation(motion, joint.name), 0.01)) for joint in closed for form in forms]

    def _gap(self, model: Model, joint: Joint, reached: float) -> Proposal:
        gap = {"clearance": Parameter(0.0, 0.0, reached)}
        starts = [{}, *grid(clearance=[share * reached for share in (0.05, 0.2, 0.5)])]
        return changed(model, joint, Effect(self.physics, "gap", joint.law, gap, "clearance", starts))

    def _toe(self, model: Model, joint: Joint, reached: float) -> Proposal:
        soft = {"clearance": Parameter(0.0, 0.0, reached), "toe": Parameter(0.0, 0.0, reached)}
        starts = grid(clearance=[share * reached for share in (0.0, 0.05, 0.2)], toe=[0.05 * reached])
        proposal = changed(model, joint, Effect(self.physics, "toe", joint.law, soft, "clearance", starts))
        return evolve(proposal, null=dict.fromkeys(proposal.parameters, 0.0))


def _is_closed(joint: Joint) -> bool:
    gap = joint.parameters.get("clearance")
    return isinstance(gap, Parameter) and gap.fixed and gap.value == 0.0
