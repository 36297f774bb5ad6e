"""A force that no known physics explains, estimated from the recordings as a smooth law."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, Table, at_a_distance, between, driven, grounded, linked, multiplied, parallel
from crashkit_hypotheses.sizes import (
    approaching,
    compressed,
    forces_recorded,
    largest_deformation,
    largest_extension,
    largest_force,
    largest_rate,
    largest_travel,
)

KNOTS = 24
LINKED = "deformation of"
"""Of another joint, whose name follows: form of a table."""
LEAST = 1e-3
"""m, of a travel that bumps cover."""
MOST = 2.0
"""Times the largest force of the joint: no height is larger."""
USUAL = 0.02
"""Of the largest force: the size that heights are expected to have. What the joint's own law explains as well is left to that
law, of which more is known outside the runs."""
APART = 0.2
"""Of the deformation reached: at least so far apart the ends of a joint may act on each other, at most as far as all of it."""
RARE = 0.01
"""Odds that they do, against a force that only acts while they touch."""
SHARE = 0.2
"""The size that is expected of what another joint's deformation multiplies a force by."""
LARGE = 0.06
"""The same of a force of the time that several runs have in common, or of what another joint does: no law of the model could
explain it."""


class Unknown(Hypothesis):
    """A smooth table f over the range that the recordings cover.

    In a joint F = F_law + f(d), unloading in its own way or along f itself, there also where its ends are apart,
    F_law + f(ddot), F_law (1 + f(ddot)), F_law + f(t), F_law (1 + f(d of another joint)) or, on a line, F_law + f(d of
    another joint); on a body f(t), f(v) or f(travel); between two bodies that no joint joins f(approach).
    """

    physics: ClassVar[str] = "unknown"
    sentence: ClassVar[str] = "{place} carries a force that none of the known physics explains"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed, every two bodies that approach each other without one, and every body on which a
        force is something else than one in its mount."""
        used = compressed(model, motion)
        pushed = [body for body in model.bodies if _differs(model, body, recordings)]
        in_joints = [form for joint in used for form in self._in_joint(model, joint, motion)]
        between_bodies = [self._between(model, pair, reach, motion) for pair, reach in approaching(model, motion).items()]
        linked = [form for joint in used for form in self._linked(model, joint, used, motion)]
        return in_joints + linked + between_bodies + [form for body in pushed for form in self._on_body(model, body, motion)]

    def _in_joint(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        largest = max(largest_force(motion, joint.name), 1.0)
        reach, fastest = largest_deformation(motion, joint.name), largest_rate(motion, joint.name)
        of_deformation = _of_deformation(largest, reach)
        both_ways = {name: value for name, value in of_deformation.items() if name != "unloading_length"}
        apart = min(max(APART * reach, largest_extension(motion, joint.name)), reach)
        from_afar = {**both_ways, "reach": Parameter(apart + reach, fixed=True)}
        of_rate: Table = {"heights": _heights(largest), "reach": Parameter(fastest, fixed=True)}
        share: Table = {"rate_heights": _heights(1.0), "rate_reach": Parameter(fastest, fixed=True)}
        of_time = _of_time(largest, motion)
        far = Effect(self.physics, "deformation, at a distance", "smooth_table", from_afar, "heights")
        return [
            parallel(model, joint, Effect(self.physics, "deformation", "smooth_table", of_deformation, "heights")),
            parallel(model, joint, Effect(self.physics, "deformation, both ways", "smooth_table", both_ways, "heights")),
            *(evolve(form, odds=RARE) for form in at_a_distance(model, joint, far, apart)),
            parallel(model, joint, Effect(self.physics, "rate", "rate_table", of_rate, "heights")),
            multiplied(model, joint, Effect(self.physics, "rate, as a factor", "rate_curve", share, "rate_heights")),
            parallel(model, joint, Effect(self.physics, "time", "time_table", of_time, "heights")),
        ]

    def _linked(self, model: Model, joint: Joint, used: Sequence[Joint], motion: Sequence[xr.Dataset]) -> list[Proposal]:
        """What other joints may do to this one: multiply its force or, on a line, add to it; asked where all else leaves
        something."""
        largest, forms = max(largest_force(motion, joint.name), 1.0), []
        for other in (one for one in used if set(one.bodies) != set(joint.bodies)):
            name, reach = f"{LINKED} {other.name}", largest_deformation(motion, other.name)
            share: Table = {"driver_heights": _heights(1.0, SHARE), "driver_reach": Parameter(reach, fixed=True)}
            factor = Effect(self.physics, f"{name}, as a factor", "driven_curve", share, "driver_heights")
            forms.append(driven(model, joint, other, factor))
            if len(model.axes) == 1:
                own = _of_deformation(largest, reach, LARGE)
                forms.append(linked(model, joint, other, Effect(self.physics, name, "smooth_table", own, "heights")))
        return [evolve(form, refined=True) for form in forms]

    def _between(self, model: Model, pair: tuple[str, str], reach: float, motion: Sequence[xr.Dataset]) -> Proposal:
        own = _of_deformation(_largest_at(model, pair, motion), reach)
        return between(model, pair, Effect(self.physics, "deformation", "smooth_table", own, "heights"))

    def _on_body(self, model: Model, body: Body, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        largest = _largest_at(model, (body.name,), motion)
        fastest = max(float(np.nanmax(np.abs(one["velocity"].sel(body=body.name).values))) for one in motion)
        of_time = _of_time(largest, motion)
        of_speed: Table = {"heights": _heights(largest), "reach": Parameter(fastest, fixed=True)}
        of_travel: Table = {
            "heights": _heights(largest),
            "reach": Parameter(max(largest_travel(motion, body.name), LEAST), fixed=True),
        }
        return [
            grounded(model, body, Effect(self.physics, "time", "time_table", of_time, "heights")),
            grounded(model, body, Effect(self.physics, "speed", "rate_table", of_speed, "heights")),
            grounded(model, body, Effect(self.physics, "travel", "smooth_table", of_travel, "heights")),
        ]


def _differs(model: Model, body: Body, recordings: Sequence[xr.DataTree]) -> bool:
    """Whether a force on a body is told from one in a joint that holds it to the ground, of which only a load cell knows."""
    if body.fixed or body.mass is None or body.carrier:
        return False
    joints = [joint for joint in model.joints if body.name in joint.bodies]
    held = any(model.body(name).fixed for joint in joints for name in joint.bodies if name != body.name)
    return bool(joints) and (not held or forces_recorded(recordings))


def _largest_at(model: Model, bodies: Sequence[str], motion: Sequence[xr.Dataset]) -> float:
    """The largest force in the joints of these bodies, N."""
    return max(largest_force(motion, joint.name) for joint in model.joints if not set(bodies).isdisjoint(joint.bodies))


def _of_deformation(largest: float, reach: float, usual: float = USUAL) -> Table:
    return {
        "heights": _heights(largest, usual),
        "reach": Parameter(reach, fixed=True),
        "unloading_length": Parameter(0.03 * reach, 1e-3 * reach, 2.0 * reach),
    }


def _of_time(largest: float, motion: Sequence[xr.Dataset]) -> Table:
    """Over the time that the longest run takes."""
    duration = Parameter(max(float(one["time"].values[-1]) for one in motion), fixed=True)
    return {"heights": _heights(largest, LARGE if len(motion) > 1 else USUAL), "duration": duration}


def _heights(largest: float, usual: float = USUAL) -> tuple[Parameter, ...]:
    return (Parameter(0.0, -MOST * largest, MOST * largest, size=usual * largest),) * KNOTS
