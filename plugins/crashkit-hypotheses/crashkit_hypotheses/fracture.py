"""A joint loses part or all of its force for good."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import (
    grid,
    largest_deformation,
    largest_extension,
    largest_rate,
    multiplied,
    pulls,
    sampling_interval,
)

LOSS = Parameter(0.0, 0.0, 1.0)
SHARES = (0.02, 0.15, 0.35, 0.6, 0.8)


class Fracture(Hypothesis):
    """F = F_law (1 - loss) for good: beyond a compression, at once or over a length, or beyond an extension.

    A member whose force rises as it is deformed breaks at a force where it breaks at a deformation; the two are one form.
    """

    physics: ClassVar[str] = "fracture"
    sentence: ClassVar[str] = "{place} breaks: it loses part of its force for good"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A loss at every joint that is compressed, a tear at every joint that pulls."""
        sound = [joint for joint in model.joints if "loss" not in joint.parameters]
        pressed = [joint for joint in sound if largest_deformation(motion, joint.name) > 0]
        pulled = [joint for joint in sound if pulls(motion, joint.name)]
        return [
            *(self._pressed(model, joint, motion, recordings) for joint in pressed),
            *(self._tear(model, joint, largest_extension(motion, joint.name)) for joint in pulled),
        ]

    def _pressed(
        self, model: Model, joint: Joint, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]
    ) -> Proposal:
        reached = largest_deformation(motion, joint.name)
        # Within one sample a loss is a jump, of which the readings show no slope: the search would not see its way.
        shortest = 0.5 * sampling_interval(recordings) * largest_rate(motion, joint.name)
        softening = {
            "loss": LOSS,
            "softening_deformation": Parameter(0.0, 0.0, 1.5 * reached),
            "softening_length": Parameter(0.25 * reached, min(shortest, 0.1 * reached), 2.0 * reached),
        }
        starts = grid(softening_deformation=[share * reached for share in SHARES])
        return multiplied(model, joint, self.physics, "compression", "softening", softening, "loss", starts)

    def _tear(self, model: Model, joint: Joint, reached: float) -> Proposal:
        tear = {
            "loss": LOSS,
            "tear_extension": Parameter(0.5 * reached, 0.01 * reached, 1.5 * reached),
            "duration": Parameter(5e-4, fixed=True),
        }
        starts = grid(tear_extension=[share * reached for share in (0.3, 0.7)])
        return multiplied(model, joint, self.physics, "tear", "tear", tear, "loss", starts)
