"""Forces that act beside a joint's law: damping, friction."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, grid, multiplied, parallel, pushing_beside
from crashkit_hypotheses.sizes import compressed, largest_deformation, largest_extension, largest_rate, largest_recoil

BRISTLE = 0.05
"""Of the deformation reached: length of a bristle to start from."""
SLIP_RATE, FASTEST_SLIP = 0.4, 3.0
"""m/s: how fast smooth friction slides once it is established, to start from, and at most."""
TAIL = {"tail": Parameter(1.0, -0.5, 2.5)}
"""Of smooth friction that is long in reaching its full force."""
REFINED = ("smooth and falling", "smooth with a tail")
"""The forms of friction that are only tried where another was found: they take many shapes."""
MOST_RISING = -0.5
"""Of friction that rises with the rate, what it has less at first: more would be a damper."""
SPRUNG_BACK = 0.5
"""Share of its deformation from which on a joint that springs back may part, with friction or another load."""
SLOWEST = 0.5
"""m/s, below which friction is not asked how it changes with the rate."""


class ViscousDamping(Hypothesis):
    """F = F_law + c ddot, F_law + c ddot |ddot|^(n - 1), or another c on the way back or from some rate on; while compressed,
    at all times, or in a joint that only pushes."""

    physics: ClassVar[str] = "viscous_damping"
    sentence: ClassVar[str] = "{place} is damped: part of its force opposes the deformation rate and grows with it"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        fastest = max(largest_rate(motion, joint.name), SLOWEST)
        damping = {"damping": Parameter(0.0, 0.0, 1e7)}
        exponent = {**damping, "exponent": Parameter(0.7, 0.2, 3.0)}
        rebound = {**damping, "exponent": Parameter(1.0, 0.2, 3.0), "rebound": Parameter(1.0, 0.0, 10.0)}
        opening = {
            **damping,
            "knee_rate": Parameter(0.3 * fastest, 0.01 * fastest, fastest),
            "beyond": Parameter(0.5, 0.0, 5.0),
        }
        linear = Effect(self.physics, "linear", "viscous", damping, "damping")
        power = Effect(self.physics, "power", "viscous_power", exponent, "damping", grid(exponent=(0.6, 2.0)))
        two_way = Effect(self.physics, "two-way", "viscous_power", rebound, "damping", grid(rebound=(0.4, 2.5)))
        starts = grid(knee_rate=(0.15 * fastest, 0.4 * fastest))
        knee = Effect(self.physics, "with a knee", "viscous_knee", opening, "damping", starts)
        plain = [parallel(model, joint, effect) for effect in (linear, power, _always(power))]
        fine = [parallel(model, joint, effect) for effect in (two_way, _always(two_way), knee)]
        only = [evolve(effect, form=f"{effect.form}, only pushing") for effect in (linear, power, two_way, knee)]
        pushing = [form for effect in only for form in pushing_beside(model, joint, effect)]
        return [*plain, *pushing[:1], *(evolve(form, refined=True) for form in (*fine, *pushing[1:]))]


class JointFriction(Hypothesis):
    """F = F_law + f sign(ddot), smoothed at low rates or over the length of a bristle, at all times or while compressed; or
    F_law (1 + m sign(ddot)), where the joint's own force presses what rubs; or both, where something else presses it too; at
    low rates another."""

    physics: ClassVar[str] = "joint_friction"
    sentence: ClassVar[str] = "a dry friction force opposes the deformation of {place}"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed; where it may also part, friction may act all the same or only while it is closed."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        reached = largest_deformation(motion, joint.name)
        force = {"friction_force": Parameter(0.0, 0.0, 1e7)}
        length = Parameter(BRISTLE * reached, 1e-3 * BRISTLE * reached, reached)
        less, established = falling(largest_rate(motion, joint.name)), smooth(largest_rate(motion, joint.name))
        laws = {
            "sharp": ("coulomb", {**force, "slip_rate": Parameter(0.05, fixed=True)}),
            "smooth": ("coulomb", force | established),
            "falling": ("coulomb", less),
            REFINED[0]: ("coulomb", less | established),
            REFINED[1]: ("coulomb", force | established | TAIL),
            "bristles": ("dahl", {**force, "bristle_length": length}),
        }
        always, closed = ({"always": Parameter(flag, fixed=True)} for flag in (1.0, 0.0))
        may_part = largest_extension(motion, joint.name) > 0.0 or largest_recoil(motion, joint.name) > SPRUNG_BACK * reached
        times = {"": always, ", while compressed": closed} if may_part else {"": always}
        told = [
            (form, Effect(self.physics, f"{form}{when}", law, {**numbers, **during}, "friction_force"))
            for form, (law, numbers) in laws.items()
            for when, during in times.items()
        ]
        odds = 1.0 / len(times)
        beside = [evolve(parallel(model, joint, effect), refined=form in REFINED, odds=odds) for form, effect in told]
        pushing = Effect(self.physics, "smooth, only pushing", "coulomb", force | established | closed, "friction_force")
        slower_pushing = evolve(pushing, form="smooth and falling, only pushing", parameters=less | established | closed)
        share = {"friction_share": Parameter(0.0, 0.0, 1.0), "slip_rate": Parameter(0.1, 0.01, 1.0)}
        pressed = Effect(self.physics, "in proportion", "rubbing", share, "friction_share")
        preload = Effect(self.physics, "preloaded", "coulomb", force | established | always, "friction_force")
        # A share that rises with the rate is a rate effect.
        slower = {"slip_rate": less["slip_rate"], "stick": evolve(less["stick"], lower=0.0), "stick_rate": less["stick_rate"]}
        slipping = evolve(pressed, form="in proportion, falling", parameters={**share, **slower})
        fine = [
            *(form for effect in (pushing, slower_pushing) for form in pushing_beside(model, joint, effect)),
            multiplied(model, joint, slipping),
            _both(model, joint, pressed, preload),
            _both(model, joint, slipping, evolve(preload, parameters=less | always)),
        ]
        plain = [*beside, evolve(multiplied(model, joint, pressed), odds=odds)]
        return [*plain, *(evolve(form, refined=True, odds=odds) for form in fine)]


def smooth(fastest: float) -> dict[str, Parameter]:
    """Of friction: how fast it slides once it is established, m/s. Beyond the fastest there was it would be a damper."""
    fastest = min(max(fastest, SLOWEST), FASTEST_SLIP)
    return {"slip_rate": Parameter(min(SLIP_RATE, 0.3 * fastest), 0.01, fastest)}


def falling(fastest: float) -> dict[str, Parameter]:
    """Parameters of friction that changes with the rate, m/s, up to the fastest there was."""
    fastest = max(fastest, SLOWEST)
    return {
        "friction_force": Parameter(0.0, 0.0, 1e7),
        "slip_rate": Parameter(0.05, fixed=True),
        "stick": Parameter(0.3, MOST_RISING, 9.0),
        "stick_rate": Parameter(0.2 * fastest, 0.02 * fastest, 2.0 * fastest),
    }


def _both(model: Model, joint: Joint, factor: Effect, force: Effect) -> Proposal:
    """A factor on a joint and a force beside it, which are one effect."""
    beside = parallel(model, joint, force)
    both = multiplied(beside.model, joint, factor)
    names, null = (*both.parameters, *beside.parameters), {**both.null, **beside.null}
    return evolve(both, form=f"{factor.form}, {force.form}", parameters=names, null=null)


def _always(damping: Effect) -> Effect:
    """The same at all times."""
    parameters = {**damping.parameters, "tension": Parameter(1.0, fixed=True)}
    return evolve(damping, form=f"{damping.form}, always", parameters=parameters)
