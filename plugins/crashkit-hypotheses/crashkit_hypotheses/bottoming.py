"""A joint stiffens sharply at large deformation."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, added, grid, parallel
from crashkit_hypotheses.sizes import compressed, largest_deformation

LOSS = Parameter(0.1, 0.0, 10.0)
"""s m-1, of a stop that is damped."""
DAMPING = Parameter(0.0, 0.0, 1e7)
"""N s m-1, of one with a dashpot."""
SHARES = (0.5, 0.7, 0.85, 0.95)
PLAIN = ("line", "parabola", "locking", "line, both ways", "parabola, both ways")


class Bottoming(Hypothesis):
    """F = F_law(d) + k x, + c x^2, + k x / (1 - x / l), + P (exp(x / l) - 1) or + P (x / l)^n, with x = max(0, d - e).

    What stiffens is crushed, and unloads with the law, or is a stop beside it that gives back what it took, or, as Hunt and
    Crossley's, a part of that: P (x / l)^n max(0, 1 + c ddot), or max(0, k x + c ddot).
    """

    physics: ClassVar[str] = "bottoming"
    sentence: ClassVar[str] = "{place} bottoms out: it stiffens sharply at large deformation"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A line, a parabola, a lock, an exponential and a power at every joint that is compressed, in its law and beside it,
        from several engagements."""
        used = compressed(model, motion)
        return [form for joint in used for form in self._forms(model, joint, largest_deformation(motion, joint.name))]

    def _forms(self, model: Model, joint: Joint, reached: float) -> list[Proposal]:
        line, *_, power = stops = self._stops(reached)
        damped = evolve(power, form="damped", law="hunt_crossley", parameters={**power.parameters, "loss": LOSS})
        dashpot = evolve(line, form="with a dashpot", law="damped_stop", parameters={**line.parameters, "damping": DAMPING})
        forms = [*_placed(model, joint, stops), *(parallel(model, joint, one) for one in (damped, dashpot))]
        return [evolve(form, refined=form.form not in PLAIN) for form in forms]

    def _stops(self, reached: float) -> list[Effect]:
        """Of a joint that is deformed so far, m."""
        stop = {"stop_deformation": Parameter(0.8 * reached, 0.2 * reached, 1.2 * reached)}
        slope, force = {"stiffness": Parameter(0.0, 0.0, 1e10)}, {"force": Parameter(0.0, 0.0, 1e8)}
        curvature = {"coefficient": Parameter(0.0, 0.0, 1e12)}
        lock = {"locking_way": Parameter(0.5 * reached, 0.02 * reached, 5.0 * reached)}
        growth = {"growth_way": Parameter(0.1 * reached, 0.01 * reached, 2.0 * reached)}
        power = {"exponent": Parameter(2.5, 1.0, 4.0), "way": Parameter(0.3 * reached, fixed=True)}
        starts = grid(stop_deformation=[share * reached for share in SHARES])
        return [
            Effect(self.physics, "line", "linear_stop", slope | stop, "stiffness", starts),
            Effect(self.physics, "parabola", "quadratic_stop", curvature | stop, "coefficient", starts),
            Effect(self.physics, "locking", "locking_stop", slope | stop | lock, "stiffness", starts),
            Effect(self.physics, "exponential", "exponential_stop", force | stop | growth, "force", starts),
            Effect(self.physics, "power", "power_stop", force | stop | power, "force", starts),
        ]


def _placed(model: Model, joint: Joint, stops: Sequence[Effect]) -> list[Proposal]:
    """In the law of the joint, and beside it."""
    crushed = [added(model, joint, stop) for stop in stops]
    elastic = [parallel(model, joint, evolve(stop, form=f"{stop.form}, both ways")) for stop in stops]
    # A law that takes nothing more has both beside it.
    known = [stop.model for stop in crushed]
    return [*crushed, *(stop for stop in elastic if stop.model not in known)]
