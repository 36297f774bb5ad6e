"""Forces that act beside a joint's law: damping, friction, a peak, folds."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, added, grid, multiplied, parallel, pushing_beside
from crashkit_hypotheses.sizes import largest_deformation, largest_extension, largest_rate, largest_recoil

BEFORE = 1.6
"""Times the deformation at which the plateau begins: a peak beyond that is none before the plateau."""
PASSED = 0.85
"""Of the deformation reached: a peak that is hardly passed shows as a rise alone, which is no peak."""
PROPORTIONAL = 0.9
"""Of the largest force per deformation."""
FIRST = 0.02
"""Of the deformation reached: no plateau is taken to begin before."""
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
LATEST, LAST = 0.3, 0.5
"""Of the deformation reached: folds are looked for from there at the latest, and none begin later."""
FOLDS = (2.0, 2.75, 3.5, 4.5, 5.5, 6.5, 8.0, 10.0, 12.5)
"""How many folds to start from: a search only finds the number that is nearest."""
LONGEST, LONGEST_SHAPED = 0.5, 0.4
"""Of the deformation reached: what is longer does not repeat. It could be any force, above all in folds of any shape."""
FADING = 0.7
"""Logarithm by which each fold may be lower: what loses more than half with every fold does not repeat either."""
SKEW = 0.1
"""To start from: without skew, folds are a sine, which has no derivative to it."""
PHASES = (0.0, -1 / 3, 1 / 3)
"""Where in a fold the first begins, likewise."""


class ViscousDamping(Hypothesis):
    """F = F_law + c ddot, F_law + c ddot |ddot|^(n - 1), or another c on the way back; while compressed, at all times, or in
    a joint that only pushes."""

    physics: ClassVar[str] = "viscous_damping"
    sentence: ClassVar[str] = "{place} is damped: part of its force opposes the deformation rate and grows with it"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed."""
        return [form for joint in _used(model, motion) for form in self._forms(model, joint)]

    def _forms(self, model: Model, joint: Joint) -> list[Proposal]:
        damping = {"damping": Parameter(0.0, 0.0, 1e7)}
        exponent = {**damping, "exponent": Parameter(0.7, 0.2, 3.0)}
        rebound = {**damping, "exponent": Parameter(1.0, 0.2, 3.0), "rebound": Parameter(1.0, 0.0, 10.0)}
        linear = Effect(self.physics, "linear", "viscous", damping, "damping")
        power = Effect(self.physics, "power", "viscous_power", exponent, "damping", grid(exponent=(0.6, 2.0)))
        two_way = Effect(self.physics, "two-way", "viscous_power", rebound, "damping", grid(rebound=(0.4, 2.5)))
        plain = [parallel(model, joint, effect) for effect in (linear, power, _always(power))]
        fine = [parallel(model, joint, effect) for effect in (two_way, _always(two_way))]
        only = [evolve(effect, form=f"{effect.form}, only pushing") for effect in (linear, power, two_way)]
        pushing = [form for effect in only for form in pushing_beside(model, joint, effect)]
        return [*plain, *pushing[:1], *(evolve(form, refined=True) for form in (*fine, *pushing[1:]))]


class JointFriction(Hypothesis):
    """F = F_law + f sign(ddot), smoothed at low rates or over the length of a bristle, at all times or while compressed; or
    F_law (1 + m sign(ddot)), where the joint's own force presses what rubs; or both, where something else presses it too."""

    physics: ClassVar[str] = "joint_friction"
    sentence: ClassVar[str] = "a dry friction force opposes the deformation of {place}"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed; where it may also part, friction may act all the same or only while it is closed."""
        return [form for joint in _used(model, motion) for form in self._forms(model, joint, motion)]

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
        share = {"friction_share": Parameter(0.0, 0.0, 1.0), "slip_rate": Parameter(0.1, 0.01, 1.0)}
        pressed = Effect(self.physics, "in proportion", "rubbing", share, "friction_share")
        preload = Effect(self.physics, "preloaded", "coulomb", force | established | always, "friction_force")
        fine = [
            *pushing_beside(model, joint, pushing),
            multiplied(model, joint, pressed),
            _both(model, joint, pressed, preload),
        ]
        return [*beside, *(evolve(form, refined=True, odds=odds) for form in fine)]


class PeakLoad(Hypothesis):
    """F = F_law + a peak on first loading."""

    physics: ClassVar[str] = "peak_load"
    sentence: ClassVar[str] = "{place} shows a peak of force before its plateau"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A peak at several deformations of every joint that is compressed."""
        return [form for joint in _used(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        reached, plateau = largest_deformation(motion, joint.name), _plateau(motion, joint.name)
        latest = min(BEFORE * plateau, PASSED * reached)
        peak = {
            "peak_force": Parameter(0.0, 0.0, 1e8),
            "peak_deformation": Parameter(0.1 * reached, 0.01 * reached, PASSED * reached),
        }
        narrow = {
            "peak_force": Parameter(0.0, 0.0, 1e8),
            "peak_deformation": Parameter(min(plateau, latest), 0.01 * reached, latest),
            "peak_sharpness": Parameter(8.0, 1.0, 200.0),
        }
        width = {"peak_width": Parameter(0.4 * plateau, 0.01 * plateau, BEFORE * plateau)}
        flanked = {name: narrow[name] for name in peak} | width
        uneven = flanked | {"peak_rise": width["peak_width"]}
        starts = grid(peak_deformation=(0.08 * reached, 0.2 * reached))
        narrow_starts = grid(peak_deformation=[min(share * plateau, latest) for share in (0.7, 1.0, 1.4)])
        dipping = flanked | {"dip": Parameter(0.3, 0.0, 2.0), "recovery": Parameter(0.2 * reached, 0.01 * reached, reached)}
        shapes = (
            ("pointed", "pointed_peak", flanked),
            ("uneven", "pointed_peak", uneven),
            ("bell", "bell_peak", flanked),
        )
        fine = [Effect(self.physics, form, law, own, "peak_force", narrow_starts) for form, law, own in shapes]
        return [
            added(model, joint, Effect(self.physics, "bump", "peak", peak, "peak_force", starts)),
            added(model, joint, Effect(self.physics, "narrow", "peak", narrow, "peak_force", narrow_starts)),
            added(model, joint, Effect(self.physics, "with a dip", "dipping_peak", dipping, "peak_force", narrow_starts)),
            *(evolve(added(model, joint, effect), refined=True) for effect in fine),
        ]


class ProgressiveFolding(Hypothesis):
    """F = F_law + a force that oscillates with deformation: a sine, or folds of any shape, that get shorter, longer, lower."""

    physics: ClassVar[str] = "progressive_folding"
    sentence: ClassVar[str] = "the force of {place} oscillates with deformation: it folds progressively"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Folds of several lengths at every joint that is compressed."""
        return [form for joint in _used(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        reached, plateau = largest_deformation(motion, joint.name), _plateau(motion, joint.name)
        folds = {
            "amplitude": Parameter(0.0, 0.0, 1e7),
            "fold_length": Parameter(0.2 * reached, 0.02 * reached, LONGEST * reached),
            "onset": Parameter(0.0, 0.0, LAST * reached),
        }
        shaped = {
            **folds,
            "fold_length": Parameter(0.2 * reached, 0.02 * reached, LONGEST_SHAPED * reached),
            "skew": Parameter(SKEW, -0.98, 0.98),
            "arch": Parameter(0.1, 0.0, 0.95),
            "shortening": Parameter(0.0, -0.3, 0.5),
            "weakening": Parameter(0.01, 0.0, FADING),
        }
        begin = min(plateau, LATEST * reached)
        lengths = [(reached - begin) / number for number in FOLDS]
        starts = [{"fold_length": one, "onset": max(0.0, begin + phase * one)} for phase in PHASES for one in lengths]
        of_one_phase = [start for start in starts[: len(lengths)] if start["fold_length"] < LONGEST_SHAPED * reached]
        return [
            added(model, joint, Effect(self.physics, "sine", "folding", folds, "amplitude", starts)),
            added(model, joint, Effect(self.physics, "shaped", "folding", shaped, "amplitude", of_one_phase)),
        ]


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


def _used(model: Model, motion: Sequence[xr.Dataset]) -> list[Joint]:
    return [joint for joint in model.joints if largest_deformation(motion, joint.name) > 0]


def _plateau(motion: Sequence[xr.Dataset], joint: str) -> float:
    """m, deformation at which a joint first carries plainly less than in proportion to its deformation."""
    deepest = max(motion, key=lambda run: float(run["deformation"].sel(joint=joint).max()))
    deformation, force = (deepest[name].sel(joint=joint).values for name in ("deformation", "force"))
    reached = float(np.nanmax(deformation))
    loading = (np.arange(len(force)) <= np.nanargmax(deformation)) & (deformation > FIRST * reached)
    secant = force[loading] / deformation[loading]
    yields = secant < PROPORTIONAL * np.maximum.accumulate(secant)
    return float(deformation[loading][np.argmax(yields)]) if yields.any() else reached
