"""A joint does not give its energy back."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import changed, grid, largest_deformation, largest_force, multiplied

LEVEL = Parameter(1.0, fixed=True)
"""N/m, a slope so small that the joint keeps its largest force on the way back, for a factor to lessen."""


class PlasticUnloading(Hypothesis):
    """Instead of along its loading curve it unloads along F = F_load(d_max) - k (d_max - d), loses a share on the way back, or
    falls along F = F_load(d_max) ((d - s d_max) / ((1 - s) d_max))^n to a share s of its largest deformation."""

    physics: ClassVar[str] = "plastic_unloading"
    sentence: ClassVar[str] = "{place} unloads along a path of its own and keeps part of its energy"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law can unload by its own slope and does not."""
        elastic = [joint for joint in model.joints if _is_elastic(joint)]
        used = [joint for joint in elastic if largest_deformation(motion, joint.name) > 0]
        return [form(model, joint, motion) for joint in used for form in (self._line, self._fading, self._set)]

    def _line(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        secant = max(largest_force(motion, joint.name) / largest_deformation(motion, joint.name), 1e3)
        slope = {"unloading_stiffness": Parameter(3.0 * secant, 0.1 * secant, 1e3 * secant)}
        starts = grid(unloading_stiffness=(2.0 * secant, 6.0 * secant, 30.0 * secant))
        return changed(model, joint, self.physics, "line", slope, "unloading_stiffness", starts, null=None)

    def _fading(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        reached = largest_deformation(motion, joint.name)
        fading = {
            "loss": Parameter(0.0, 0.0, 1.0),
            "unloading_length": Parameter(0.1 * reached, 1e-3 * reached, 3.0 * reached),
        }
        starts = grid(unloading_length=[share * reached for share in (0.03, 0.1, 0.4)])
        return multiplied(model, joint, self.physics, "fading", "unloading_loss", fading, "loss", starts)

    def _set(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        level = evolve(joint, parameters={**joint.parameters, "unloading_stiffness": LEVEL})
        unloading = evolve(model, joints=tuple(level if j.name == joint.name else j for j in model.joints))
        back = {
            "residual_share": Parameter(0.3, 0.0, 0.99),
            "unloading_exponent": Parameter(1.2, 1.0, 10.0),
            "loss": Parameter(1.0, fixed=True),
        }
        starts = grid(residual_share=(0.2, 0.5, 0.8))
        one = multiplied(unloading, level, self.physics, "set", "residual_set", back, "residual_share", starts)
        return evolve(one, null={})


def _is_elastic(joint: Joint) -> bool:
    slope = joint.parameters.get("unloading_stiffness")
    return isinstance(slope, Parameter) and slope.value == 0.0
