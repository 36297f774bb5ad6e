"""A joint loses part or all of its force for good."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import Effect, added, grid, multiplied
from crashkit_hypotheses.sizes import (
    duration,
    is_compressed,
    largest_deformation,
    largest_extension,
    largest_force,
    largest_rate,
    pulls,
    sampling_interval,
)

LOSS = Parameter(0.0, 0.0, 1.0)
SHARES = (0.02, 0.15, 0.35, 0.6, 0.8)
"""Of the deformation reached: where a loss begins."""
FIRST, STEPS = (0.1, 0.3, 0.5), (0.25, 0.4)
"""The same of the first of two, and the way to the second."""


class Fracture(Hypothesis):
    """F = F_law (1 - loss) for good: beyond a compression, at once, over a length, smoothly, in two steps or in time, or
    beyond an extension; or only the loading curve loses a force, and unloading is as steep as before.

    A member whose force rises as it is deformed breaks at a force where it breaks at a deformation; the two are one form.
    """

    physics: ClassVar[str] = "fracture"
    sentence: ClassVar[str] = "{place} breaks: it loses part of its force for good"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A loss at every joint that is compressed, a tear at every joint that pulls."""
        sound = [joint for joint in model.joints if joint.parameters.keys().isdisjoint(("loss", "lost_force"))]
        pressed = [joint for joint in sound if is_compressed(motion, joint.name)]
        pulled = [joint for joint in sound if pulls(motion, joint.name)]
        return [
            *(form for joint in pressed for form in self._pressed(model, joint, motion, recordings)),
            *(self._tear(model, joint, largest_extension(motion, joint.name)) for joint in pulled),
        ]

    def _pressed(
        self, model: Model, joint: Joint, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]
    ) -> list[Proposal]:
        reached, force = largest_deformation(motion, joint.name), largest_force(motion, joint.name)
        # Within one sample a loss is a jump, of which the readings show no slope: the search would not see its way.
        shortest = 0.5 * sampling_interval(recordings) * largest_rate(motion, joint.name)
        softening = {
            "loss": LOSS,
            "softening_deformation": Parameter(0.0, 0.0, 1.5 * reached),
            "softening_length": Parameter(0.25 * reached, min(shortest, 0.1 * reached), 2.0 * reached),
        }
        stepwise = {
            **softening,
            "step_way": Parameter(0.3 * reached, 0.01 * reached, reached),
            "second_loss": LOSS,
        }
        starts = grid(softening_deformation=[share * reached for share in SHARES])
        ways = grid(step_way=[share * reached for share in STEPS], softening_deformation=[s * reached for s in FIRST])
        steps = [{"loss": 0.2, "second_loss": 0.2, "softening_length": 0.05 * reached} | way for way in ways]
        once = multiplied(model, joint, Effect(self.physics, "compression", "softening", softening, "loss", starts))
        twice = multiplied(model, joint, Effect(self.physics, "in two steps", "stepwise_softening", stepwise, "loss", steps))
        nothing = {path: 0.0 for path in twice.parameters if path.endswith("loss")}
        return [
            once,
            self._smooth(model, joint, reached, shortest),
            self._delayed(model, joint, reached, motion),
            evolve(twice, null=nothing, refined=True),
            *self._of_its_curve(model, joint, softening, starts, force),
        ]

    def _smooth(self, model: Model, joint: Joint, reached: float, shortest: float) -> Proposal:
        """A loss that begins and ends little by little."""
        smooth = {
            "loss": LOSS,
            "softening_middle": Parameter(0.0, 0.0, 1.5 * reached),
            "softening_spread": Parameter(0.05 * reached, min(0.5 * shortest, 0.05 * reached), reached),
        }
        starts = grid(softening_middle=[share * reached for share in SHARES[1:]])
        smoothly = Effect(self.physics, "smoothly", "smooth_softening", smooth, "loss", starts)
        return evolve(multiplied(model, joint, smoothly), refined=True)

    def _delayed(self, model: Model, joint: Joint, reached: float, motion: Sequence[xr.Dataset]) -> Proposal:
        """A loss in time, once it has been deformed so far."""
        lasts = duration(motion)
        late = {
            "softening_deformation": Parameter(0.3 * reached, 0.01 * reached, reached),
            "loss": LOSS,
            "delay": Parameter(0.05 * lasts, 0.0, lasts),
            "duration": Parameter(0.05 * lasts, 1e-3 * lasts, lasts),
            "slowing": Parameter(1.0, 0.01, 20.0),
        }
        starts = grid(softening_deformation=[share * reached for share in SHARES[1:]])
        return evolve(
            multiplied(model, joint, Effect(self.physics, "delayed", "delayed_softening", late, "loss", starts)), refined=True
        )

    def _of_its_curve(
        self,
        model: Model,
        joint: Joint,
        softening: Mapping[str, Parameter],
        starts: Sequence[Mapping[str, float]],
        largest: float,
    ) -> list[Proposal]:
        """What only its loading curve loses, where its law takes another curve in."""
        if largest == 0.0 or " " in joint.law or f"{joint.law} + lost_force" not in load().spring_laws:
            return []
        lost = {"lost_force": Parameter(0.0, 0.0, 2.0 * largest), **{n: p for n, p in softening.items() if n != "loss"}}
        curve = added(model, joint, Effect(self.physics, "of its loading curve", "lost_force", lost, "lost_force", starts))
        return [evolve(curve, refined=True)]

    def _tear(self, model: Model, joint: Joint, reached: float) -> Proposal:
        tear = {
            "loss": LOSS,
            "tear_extension": Parameter(0.5 * reached, 0.01 * reached, 1.5 * reached),
            "duration": Parameter(5e-4, fixed=True),
        }
        starts = grid(tear_extension=[share * reached for share in (0.3, 0.7)])
        return multiplied(model, joint, Effect(self.physics, "tear", "tear", tear, "loss", starts))
