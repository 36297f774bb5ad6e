"""A force that no known physics explains, estimated from the recordings as a smooth law."""

from collections.abc import Sequence, Set
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Body, Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import (
    Effect,
    Table,
    added,
    at_a_distance,
    between,
    driven,
    grid,
    grounded,
    linked,
    multiplied,
    parallel,
)
from crashkit_hypotheses.sizes import (
    approaching,
    compressed,
    duration,
    forces_recorded,
    largest_deformation,
    largest_extension,
    largest_force,
    largest_rate,
    largest_speed,
    largest_travel,
)

KNOTS = 24
BUMPS = 16
"""Where a single bump is begun."""
NARROW = 0.04
"""Of the deformation reached, or of the time recorded: how wide."""
PULSES, LARGEST = 8, 8.0
"""Where a single pulse is begun, and how large it may be, in times the largest force of the joint."""
DRIVEN = "deformation of"
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
IN_MOUNT = 0.5
"""Odds that a force of the time acts in a joint that holds a body to the ground against one on that body, where no recording
tells these apart: what goes on whatever the body does, as a machine that runs, is rather in it."""
LARGE = 0.06
"""The same of a force of the time that several runs have in common, or of what another joint does: no law of the model could
explain it."""


class Unknown(Hypothesis):
    """A smooth table f over the range that the recordings cover, or a narrow bump, or one pulse of the time.

    In a joint F = F_law + f(d), unloading in its own way or along f itself, there also where its ends are apart;
    F_law + B exp(-((d - c) / w)^2), F_law + f(ddot), F_law (1 + f(ddot)), F_law + f(t), F_law (1 + f(d of another joint)) or,
    on a line, F_law + f(d of another joint); on a body f(t), f(v) or f(travel); between two bodies that no joint joins
    f(approach).
    """

    physics: ClassVar[str] = "unknown"
    sentence: ClassVar[str] = "{place} carries a force that none of the known physics explains"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed, every two bodies that approach each other without one, and every body; where a force
        on it is the same as one in its mount, only one of the time, for the comparison."""
        used = compressed(model, motion)
        pushed = [body for body in model.bodies if _may_be_pushed(model, body)]
        held = {body.name for body in pushed if _is_held(model, body) and not forces_recorded(recordings)}
        return [
            *(form for joint in used for form in self._along(model, joint, motion)),
            *(form for joint in used for form in self._in_motion(model, joint, motion, held)),
            *(form for joint in used for form in self._narrow(model, joint, motion)),
            *(self._pulse_in(model, joint, motion) for joint in used),
            *(form for joint in used for form in self._driven(model, joint, used, motion)),
            *(self._between(model, pair, reach, motion) for pair, reach in approaching(model, motion).items()),
            *(form for body in pushed if body.name not in held for form in self._on_body(model, body, motion)),
            *(self._pulse_on(model, body, motion) for body in pushed if body.name not in held),
            *(evolve(self._on_body(model, body, motion)[0], refined=True) for body in pushed if body.name in held),
        ]

    def _along(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        """A table of the deformation: lost on the way back, not lost, or also where the ends of the joint are apart."""
        largest, reach = _largest_in(joint, motion), largest_deformation(motion, joint.name)
        lost = _of_deformation(largest, reach)
        kept = {name: value for name, value in lost.items() if name != "unloading_length"}
        apart = min(max(APART * reach, largest_extension(motion, joint.name)), reach)
        from_afar = {**kept, "reach": Parameter(apart + reach, fixed=True)}
        far = Effect(self.physics, "deformation, at a distance", "smooth_table", from_afar, "heights")
        tables = [
            Effect(self.physics, "deformation", "smooth_table", lost, "heights"),
            Effect(self.physics, "deformation, both ways", "smooth_table", kept, "heights"),
        ]
        return [
            *(evolve(parallel(model, joint, table), estimate_of="deformation") for table in tables),
            *(evolve(one, estimate_of="distance", odds=RARE) for one in at_a_distance(model, joint, far, apart)),
        ]

    def _in_motion(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset], held: Set[str]) -> list[Proposal]:
        """A table of the rate, which adds to the force or multiplies it, or of the time; `held` are bodies of which a mount
        is not told apart."""
        largest, fastest = _largest_in(joint, motion), Parameter(largest_rate(motion, joint.name), fixed=True)
        of_rate: Table = {"heights": _heights(largest), "reach": fastest}
        share: Table = {"rate_heights": _heights(1.0), "rate_reach": fastest}
        added_force = parallel(model, joint, Effect(self.physics, "rate", "rate_table", of_rate, "heights"))
        factor = multiplied(model, joint, Effect(self.physics, "rate, as a factor", "rate_curve", share, "rate_heights"))
        in_time = parallel(model, joint, Effect(self.physics, "time", "time_table", _of_time(largest, motion), "heights"))
        is_mount = any(model.body(name).fixed for name in joint.bodies) and not held.isdisjoint(joint.bodies)
        return [
            *(evolve(form, estimate_of="rate") for form in (added_force, factor)),
            evolve(in_time, estimate_of="time", odds=IN_MOUNT if is_mount else 1.0),
        ]

    def _narrow(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        """One bump, for which the heights of a table may be too far apart; asked where all else leaves something."""
        largest, reach = _largest_in(joint, motion), largest_deformation(motion, joint.name)
        bump = {
            "bump_force": Parameter(0.0, -MOST * largest, MOST * largest),
            "bump_deformation": Parameter(0.5 * reach, 0.0, reach),
            "bump_width": Parameter(NARROW * reach, 0.1 * NARROW * reach, reach),
        }
        starts = grid(bump_deformation=[(i + 0.5) / BUMPS * reach for i in range(BUMPS)])
        lost = Effect(self.physics, "bump", "bump", bump, "bump_force", starts)
        kept = evolve(lost, form="bump, both ways")
        forms = (added(model, joint, lost), parallel(model, joint, kept))
        return [evolve(form, refined=True, estimate_of="deformation") for form in forms]

    def _pulse_in(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        """One pulse of the time, for which the heights of a table may be too far apart."""
        pulse = parallel(model, joint, self._pulse(_largest_in(joint, motion), motion))
        return evolve(pulse, refined=True, estimate_of="time")

    def _pulse_on(self, model: Model, body: Body, motion: Sequence[xr.Dataset]) -> Proposal:
        """The same on a body."""
        pulse = grounded(model, body, self._pulse(_largest_at(model, (body.name,), motion), motion))
        return evolve(pulse, refined=True, estimate_of="time")

    def _pulse(self, largest: float, motion: Sequence[xr.Dataset]) -> Effect:
        longest = duration(motion)
        width = Parameter(NARROW * longest, 0.1 * NARROW * longest, longest)
        pulse = {
            "pulse_force": Parameter(0.0, -LARGEST * largest, LARGEST * largest),
            "pulse_time": Parameter(0.5 * longest, 0.0, longest),
            "rise_time": width,
            "fall_time": width,
        }
        starts = grid(pulse_time=[(i + 0.5) / PULSES * longest for i in range(PULSES)])
        return Effect(self.physics, "pulse", "pulse", pulse, "pulse_force", starts)

    def _driven(self, model: Model, joint: Joint, used: Sequence[Joint], motion: Sequence[xr.Dataset]) -> list[Proposal]:
        """What other joints may do to this one: multiply its force or, on a line, add to it; asked where all else leaves
        something."""
        forms = []
        for other in (one for one in used if set(one.bodies) != set(joint.bodies)):
            name, reach = f"{DRIVEN} {other.name}", largest_deformation(motion, other.name)
            share: Table = {"driver_heights": _heights(1.0, SHARE), "driver_reach": Parameter(reach, fixed=True)}
            factor = Effect(self.physics, f"{name}, as a factor", "driven_curve", share, "driver_heights")
            forms.append(driven(model, joint, other, factor))
            if len(model.axes) == 1:
                own = _of_deformation(_largest_in(joint, motion), reach, LARGE)
                forms.append(linked(model, joint, other, Effect(self.physics, name, "smooth_table", own, "heights")))
        return [evolve(form, refined=True, estimate_of="deformation of another joint") for form in forms]

    def _between(self, model: Model, pair: tuple[str, str], reach: float, motion: Sequence[xr.Dataset]) -> Proposal:
        own = _of_deformation(_largest_at(model, pair, motion), reach)
        table = between(model, pair, Effect(self.physics, "deformation", "smooth_table", own, "heights"))
        return evolve(table, estimate_of="deformation")

    def _on_body(self, model: Model, body: Body, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        """A table of the time, of its speed, or of how far it has come."""
        largest = _largest_at(model, (body.name,), motion)
        travel = max(largest_travel(motion, body.name), LEAST)
        of_speed: Table = {"heights": _heights(largest), "reach": Parameter(largest_speed(motion, body.name), fixed=True)}
        of_travel: Table = {"heights": _heights(largest), "reach": Parameter(travel, fixed=True)}
        tables = (
            Effect(self.physics, "time", "time_table", _of_time(largest, motion), "heights"),
            Effect(self.physics, "speed", "rate_table", of_speed, "heights"),
            Effect(self.physics, "travel", "smooth_table", of_travel, "heights"),
        )
        return [evolve(grounded(model, body, table), estimate_of=table.form) for table in tables]


def _may_be_pushed(model: Model, body: Body) -> bool:
    return not (body.fixed or body.mass is None or body.carrier) and any(body.name in joint.bodies for joint in model.joints)


def _is_held(model: Model, body: Body) -> bool:
    """Whether a joint holds it to the ground: a force in that one is told from one on the body only by a load cell."""
    joints = [joint for joint in model.joints if body.name in joint.bodies]
    return any(model.body(name).fixed for joint in joints for name in joint.bodies if name != body.name)


def _largest_in(joint: Joint, motion: Sequence[xr.Dataset]) -> float:
    """Its largest force, N; at least one."""
    return max(largest_force(motion, joint.name), 1.0)


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
    usual = LARGE if len(motion) > 1 else USUAL
    return {"heights": _heights(largest, usual), "duration": Parameter(duration(motion), fixed=True)}


def _heights(largest: float, usual: float = USUAL) -> tuple[Parameter, ...]:
    return (Parameter(0.0, -MOST * largest, MOST * largest, size=usual * largest),) * KNOTS
