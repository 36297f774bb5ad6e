"""A joint does not give its energy back."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import grid, largest_deformation, largest_force, proposal


class PlasticUnloading(Hypothesis):
    """F = F_load(d_max) - k (d_max - d) where the model unloads along its loading curve."""

    physics: ClassVar[str] = "plastic_unloading"
    sentence: ClassVar[str] = "{place} unloads along a path of its own and keeps part of its energy"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law can unload by its own slope and does not."""
        elastic = [joint for joint in model.joints if _is_elastic(joint)]
        return [self._plastic(model, joint, motion) for joint in elastic if largest_deformation(motion, joint.name) > 0]

    def _plastic(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        secant = max(largest_force(motion, joint.name) / largest_deformation(motion, joint.name), 1e3)
        slope = {"unloading_stiffness": Parameter(3.0 * secant, 0.1 * secant, 1e3 * secant)}
        changed = evolve(joint, parameters={**joint.parameters, **slope})
        augmented = evolve(model, joints=tuple(changed if j.name == joint.name else j for j in model.joints))
        starts = grid(unloading_stiffness=(2.0 * secant, 6.0 * secant, 30.0 * secant))
        location = {"joint": joint.name}
        prefix = f"joint.{joint.name}."
        return proposal(self.physics, "line", location, augmented, prefix, slope, "unloading_stiffness", starts, null=None)


def _is_elastic(joint: Joint) -> bool:
    slope = joint.parameters.get("unloading_stiffness")
    return isinstance(slope, Parameter) and slope.value == 0.0
