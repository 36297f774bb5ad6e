"""A joint engages only after a gap."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import Effect, changed, grid
from crashkit_hypotheses.sizes import largest_deformation, largest_force


class Clearance(Hypothesis):
    """F(d) becomes F(d - gap), and 0 while d < gap; or it engages softly after that, or a pad fills it, or it rubs in it."""

    physics: ClassVar[str] = "clearance"
    sentence: ClassVar[str] = "{place} engages only after a gap"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law has a clearance that is not identified already."""
        return [
            form
            for joint in model.joints
            if _is_closed(joint)
            for form in self._forms(model, joint, max(largest_deformation(motion, joint.name), 0.01), motion)
        ]

    def _forms(self, model: Model, joint: Joint, reached: float, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        engaging = [self._gap(model, joint, reached)]
        if "toe" in joint.parameters:
            engaging.append(self._toe(model, joint, reached))
        padded, rubbed = f"{joint.law} | pad", f"{joint.law} | rubbing_gap"
        if padded not in load().spring_laws or rubbed not in load().spring_laws:
            return engaging
        force = largest_force(motion, joint.name)
        rubbing = evolve(self._rubbing(model, joint, rubbed, reached, force), refined=True)
        return [*engaging, self._padded(model, joint, padded, reached, force), rubbing]

    def _gap(self, model: Model, joint: Joint, reached: float) -> Proposal:
        gap = {"clearance": Parameter(0.0, 0.0, reached)}
        starts = [{}, *grid(clearance=[share * reached for share in (0.05, 0.2, 0.5)])]
        return changed(model, joint, Effect(self.physics, "gap", joint.law, gap, "clearance", starts))

    def _toe(self, model: Model, joint: Joint, reached: float) -> Proposal:
        soft = {"clearance": Parameter(0.0, 0.0, reached), "toe": Parameter(0.0, 0.0, reached)}
        starts = grid(clearance=[share * reached for share in (0.0, 0.05, 0.2)], toe=[0.05 * reached])
        proposal = changed(model, joint, Effect(self.physics, "toe", joint.law, soft, "clearance", starts))
        return evolve(proposal, null=dict.fromkeys(proposal.parameters, 0.0))

    def _padded(self, model: Model, joint: Joint, law: str, reached: float, force: float) -> Proposal:
        pad = {
            "clearance": Parameter(0.0, 0.0, reached),
            "pad_force": Parameter(0.0, 0.0, max(force, 1.0)),
            "pad_exponent": Parameter(1.0, 0.3, 6.0),
        }
        starts = grid(clearance=[share * reached for share in (0.05, 0.2)], pad_force=[0.1 * force])
        return changed(model, joint, Effect(self.physics, "padded", law, pad, "clearance", starts, null=None))

    def _rubbing(self, model: Model, joint: Joint, law: str, reached: float, force: float) -> Proposal:
        rub = {
            "clearance": Parameter(0.0, 0.0, reached),
            "friction_force": Parameter(0.0, 0.0, max(force, 1.0)),
            "slip_rate": Parameter(0.05, fixed=True),
        }
        starts = grid(clearance=[share * reached for share in (0.05, 0.2)], friction_force=[0.03 * force])
        return changed(model, joint, Effect(self.physics, "rubbing", law, rub, "clearance", starts, null=None))


def _is_closed(joint: Joint) -> bool:
    gap = joint.parameters.get("clearance")
    return isinstance(gap, Parameter) and gap.fixed and gap.value == 0.0
