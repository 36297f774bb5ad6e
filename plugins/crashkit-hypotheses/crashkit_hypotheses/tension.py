"""A joint that was taken to push only also pulls."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import Effect, changed, grid, parallel
from crashkit_hypotheses.sizes import largest_deformation, largest_extension, largest_force, largest_recoil

STRETCHED = 1e-4
"""m."""
LIMITS, SLOPES = (0.02, 0.04, 0.08, 0.16, 0.32), (0.1, 0.3, 1.0)
"""Of the largest force, and of the joint's own line, to start from: a joint that pulls otherwise closes again at another time,
and a search that begins on the wrong side of that ends there."""


class Tension(Hypothesis):
    """The joint's own lines go on below F = 0, as steep or less, without end or to a limit; or a strap, which may yield,
    F = F_law + k min(0, d + slack); or a hook latches as it is crushed, which may yield too,
    F = F_law - P max(0, (d_max - d - play) / way)^n."""

    physics: ClassVar[str] = "tension"
    sentence: ClassVar[str] = "{place} also pulls"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Its own line at every joint that is compressed or stretched, a strap at every joint that is stretched, a hook at
        every joint that springs back."""
        proposals = []
        for joint in model.joints:
            stretch = largest_extension(motion, joint.name)
            if _only_pushes(joint) and max(stretch, largest_deformation(motion, joint.name)) > 0.0:
                pull = {"tension": Parameter(0.0, 0.0, 1.0)}
                proposals.append(changed(model, joint, Effect(self.physics, "own line", joint.law, pull, "tension")))
                proposals += self._limited(model, joint, largest_force(motion, joint.name))
            if stretch > STRETCHED:
                proposals += self._straps(model, joint, stretch, largest_force(motion, joint.name))
            recoil = largest_recoil(motion, joint.name)
            if _only_pushes(joint) and recoil > STRETCHED:
                proposals += self._hooks(model, joint, recoil, largest_force(motion, joint.name))
        return proposals

    def _limited(self, model: Model, joint: Joint, largest: float) -> list[Proposal]:
        law = load().spring_laws.get(joint.law)
        if largest == 0.0 or law is None or not any(spec.name == "tension_force" for spec in law.parameters):
            return []
        pull = {"tension_force": Parameter(0.0, 0.0, largest), "tension": Parameter(1.0, 0.0, 1.0)}
        starts = [{"tension_force": 0.0}, *grid(tension_force=[share * largest for share in LIMITS], tension=SLOPES)]
        return [changed(model, joint, Effect(self.physics, "own line, to a limit", joint.law, pull, "tension_force", starts))]

    def _straps(self, model: Model, joint: Joint, stretch: float, largest: float) -> list[Proposal]:
        strap = {"stiffness": Parameter(0.0, 0.0, 1e9), "slack": Parameter(0.0, 0.0, stretch)}
        most = max(largest, 1.0)
        limit = {"yield_force": Parameter(0.2 * most, 1e-3 * most, 2.0 * most), "corner": Parameter(2.0, 1.0, 20.0)}
        starts = grid(slack=(0.0, 0.2 * stretch, 0.5 * stretch))
        straight = Effect(self.physics, "strap", "tension_spring", strap, "stiffness", starts)
        yields = Effect(self.physics, "strap, yielding", "yielding_strap", strap | limit, "stiffness", starts)
        return [parallel(model, joint, straight), evolve(parallel(model, joint, yields), refined=True)]

    def _hooks(self, model: Model, joint: Joint, recoil: float, largest: float) -> list[Proposal]:
        hook = {
            "pull_force": Parameter(0.0, 0.0, 1e7),
            "play": Parameter(0.0, 0.0, recoil),
            "pull_exponent": Parameter(1.0, 1.0, 4.0),
            "way": Parameter(0.1 * recoil, fixed=True),
        }
        most = max(largest, 1.0)
        limit = {"pull_limit": Parameter(0.2 * most, 1e-3 * most, 2.0 * most)}
        starts = grid(play=(0.1 * recoil, 0.4 * recoil))
        plain = parallel(model, joint, Effect(self.physics, "hook", "hook", hook, "pull_force", starts))
        yields = parallel(model, joint, Effect(self.physics, "hook, yielding", "hook", hook | limit, "pull_force", starts))
        return [plain, evolve(yields, refined=True)]


def _only_pushes(joint: Joint) -> bool:
    own = joint.parameters.get("tension")
    return isinstance(own, Parameter) and own.value == 0.0
