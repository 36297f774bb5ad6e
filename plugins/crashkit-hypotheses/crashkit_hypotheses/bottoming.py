"""A joint stiffens sharply at large deformation."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, added, grid, parallel
from crashkit_hypotheses.sizes import largest_deformation

LOSS = 0.1
"""s m-1, of a stop that is damped, to start from."""
SHARES = (0.5, 0.7, 0.85, 0.95)
PLAIN = ("line", "parabola", "locking", "line, both ways", "parabola, both ways")


class Bottoming(Hypothesis):
    """F = F_law(d) + k x, + c x^2, + k x / (1 - x / l), + P (exp(x / l) - 1) or + P (x / l)^n, with x = max(0, d - e).

    What stiffens is crushed, and unloads with the law, or is a stop beside it that gives back what it took, or, as Hunt and
    Crossley's, a part of that: P (x / l)^n max(0, 1 + c ddot).
    """

    physics: ClassVar[str] = "bottoming"
    sentence: ClassVar[str] = "{place} bottoms out: it stiffens sharply at large deformation"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A line, a parabola, a lock, an exponential and a power at every joint that is compressed, in its law and beside it,
        from several engagements."""
        reached = {joint.name: largest_deformation(motion, joint.name) for joint in model.joints}
        return [
            form
            for joint in model.joints
            if reached[joint.name] > 0
            for form in self._forms(model, joint, reached[joint.name])
        ]

    def _forms(self, model: Model, joint: Joint, reached: float) -> list[Proposal]:
        stop = Parameter(0.8 * reached, 0.2 * reached, 1.2 * reached)
        line = {"stiffness": Parameter(0.0, 0.0, 1e10), "stop_deformation": stop}
        parabola = {"coefficient": Parameter(0.0, 0.0, 1e12), "stop_deformation": stop}
        way = Parameter(0.5 * reached, 0.02 * reached, 5.0 * reached)
        lock = {"stiffness": Parameter(0.0, 0.0, 1e10), "stop_deformation": stop, "locking_way": way}
        growth = {
            "force": Parameter(0.0, 0.0, 1e8),
            "stop_deformation": stop,
            "growth_way": Parameter(0.1 * reached, 0.01 * reached, 2.0 * reached),
        }
        power = {
            "force": Parameter(0.0, 0.0, 1e8),
            "stop_deformation": stop,
            "exponent": Parameter(2.5, 1.0, 4.0),
            "way": Parameter(0.3 * reached, fixed=True),
        }
        starts = grid(stop_deformation=[share * reached for share in SHARES])
        stops = (
            Effect(self.physics, "line", "linear_stop", line, "stiffness", starts),
            Effect(self.physics, "parabola", "quadratic_stop", parabola, "coefficient", starts),
            Effect(self.physics, "locking", "locking_stop", lock, "stiffness", starts),
            Effect(self.physics, "exponential", "exponential_stop", growth, "force", starts),
            Effect(self.physics, "power", "power_stop", power, "force", starts),
        )
        crushed = [added(model, joint, stop) for stop in stops]
        damped = Effect(self.physics, "damped", "hunt_crossley", power | {"loss": Parameter(LOSS, 0.0, 10.0)}, "force", starts)
        elastic = [parallel(model, joint, evolve(stop, form=f"{stop.form}, both ways")) for stop in stops]
        # A law that takes nothing more has both beside it.
        known = [stop.model for stop in crushed]
        distinct = [*crushed, *(stop for stop in elastic if stop.model not in known)]
        told = [*distinct, parallel(model, joint, damped)]
        return [evolve(stop, refined=stop.form not in PLAIN) for stop in told]
