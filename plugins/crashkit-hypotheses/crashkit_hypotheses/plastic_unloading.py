"""A joint does not give its energy back."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import changed, grid, largest_deformation, largest_force, multiplied


class PlasticUnloading(Hypothesis):
    """Instead of along its loading curve it unloads by F = F_load(d_max) - k (d_max - d), or loses a share on the way back."""

    physics: ClassVar[str] = "plastic_unloading"
    sentence: ClassVar[str] = "{place} unloads along a path of its own and keeps part of its energy"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law can unload by its own slope and does not."""
        elastic = [joint for joint in model.joints if _is_elastic(joint)]
        used = [joint for joint in elastic if largest_deformation(motion, joint.name) > 0]
        return [form(model, joint, motion) for joint in used for form in (self._line, self._fading)]

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


def _is_elastic(joint: Joint) -> bool:
    slope = joint.parameters.get("unloading_stiffness")
    return isinstance(slope, Parameter) and slope.value == 0.0
