"""Forces that act beside a joint's law: damping, friction."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, grid, multiplied, parallel, pushing_beside
from crashkit_hypotheses.friction import BACK, REFINED, SLOWEST, TAIL, falling, smooth
from crashkit_hypotheses.sizes import compressed, largest_deformation, largest_extension, largest_rate, largest_recoil

Parameters = dict[str, Parameter]
Starts = Sequence[Mapping[str, float]]
ForceLaws = Mapping[str, tuple[str, Parameters, Starts]]

BRISTLES = (0.05, 0.005)
"""Of the deformation reached: lengths of a bristle to start from; from long ones hardly a search comes to short ones."""
SPRUNG_BACK = 0.5
"""Share of its deformation from which on a joint that springs back may part, with friction or another load."""
ALWAYS, CLOSED = {"always": Parameter(1.0, fixed=True)}, {"always": Parameter(0.0, fixed=True)}
"""Friction that also acts where the joint is open, and friction that does not."""
PUSHING = ("smooth", "smooth and falling", "smooth with a tail", "bristles")
"""Forms of friction that may only push with the joint's own force: smooth friction is sharp where its slip is slow."""
LEAST_LIMIT = 0.2
"""Of the fastest rate: a damper that gives half of its limit at a lower one is friction."""
ONE_WAY = {"exponent": Parameter(1.0, fixed=True), "rebound": Parameter(0.0, fixed=True)}
"""Of a damper that does not hold back on the way back."""
PLAIN, CHECKED, COMING_IN = ("linear", "power"), "linear, one way", "saturating, coming in"
"""Forms of dampers: the first that are tried; one that does nothing on the way back, so that it pushes anyway; and one that is
only tried where it may only push, as beside a plain dashpot it took over what a recorder had lost at its start."""
FIXED_AT_BOTH_ENDS = ("power", "two-way", "saturating")
"""Forms of dampers that may also act where the joint is open."""
COMES_IN, AT_ONCE = (0.04, 0.15), 0.02
"""Of the deformation reached: lengths over which a damper comes in to start from, and the least."""
FORCE = {"friction_force": Parameter(0.0, 0.0, 1e7)}
SHARE = {"friction_share": Parameter(0.0, 0.0, 1.0), "slip_rate": Parameter(0.1, 0.01, 1.0)}


class ViscousDamping(Hypothesis):
    """F = F_law + c ddot, F_law + c ddot |ddot|^(n - 1), or with another c on the way back, from some rate on, or with the
    stroke, or c ddot / (1 + |ddot| / v_s), at once or over a length; while compressed, at all times, or in a joint that only
    pushes."""

    physics: ClassVar[str] = "viscous_damping"
    sentence: ClassVar[str] = "{place} is damped: part of its force opposes the deformation rate and grows with it"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        fastest = max(largest_rate(motion, joint.name), SLOWEST)
        laws = _damper_laws(largest_deformation(motion, joint.name), fastest)
        effects = [Effect(self.physics, form, law, own, "damping", starts) for form, (law, own, starts) in laws.items()]
        plain = [parallel(model, joint, one) for effect in effects if effect.form in PLAIN for one in _at_times(effect)]
        finer = [effect for effect in effects if effect.form not in (*PLAIN, COMING_IN)]
        fine = [parallel(model, joint, one) for effect in finer for one in _at_times(effect)]
        only = [evolve(effect, form=f"{effect.form}, only pushing") for effect in effects if effect.form != CHECKED]
        pushing = [form for effect in only for form in pushing_beside(model, joint, effect)]
        return [*plain, *pushing[:1], *(evolve(form, refined=True) for form in (*fine, *pushing[1:]))]


class JointFriction(Hypothesis):
    """F = F_law + f sign(ddot), smoothed at low rates or over the length of a bristle, at all times or while compressed; with
    another f on the way back; or F_law (1 + m sign(ddot)), where the joint's own force presses what rubs; or both, where
    something else presses it too; at low rates another."""

    physics: ClassVar[str] = "joint_friction"
    sentence: ClassVar[str] = "a dry friction force opposes the deformation of {place}"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed; where it may also part, friction may act all the same or only while it is closed."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        fastest = largest_rate(motion, joint.name)
        times = {"": ALWAYS, ", while compressed": CLOSED} if _may_part(joint, motion) else {"": ALWAYS}
        laws = _friction_laws(largest_deformation(motion, joint.name), fastest)
        plain = [*self._beside(model, joint, laws, times), multiplied(model, joint, self._in_proportion())]
        fine = [*self._only_pushing(model, joint, laws), *self._finer_in_proportion(model, joint, fastest)]
        forms = [*plain, *(evolve(form, refined=True) for form in fine)]
        return [evolve(form, odds=1.0 / len(times)) for form in forms]

    def _beside(self, model: Model, joint: Joint, laws: ForceLaws, times: Mapping[str, Parameters]) -> list[Proposal]:
        """Friction that nothing of the joint's own force presses."""
        forms = []
        for form, (law, numbers, starts) in laws.items():
            for when, during in times.items():
                effect = Effect(self.physics, f"{form}{when}", law, {**numbers, **during}, "friction_force", starts)
                forms.append(evolve(parallel(model, joint, effect), refined=form in REFINED))
        return forms

    def _only_pushing(self, model: Model, joint: Joint, laws: ForceLaws) -> list[Proposal]:
        """Friction which together with the joint's own force only pushes."""
        effects = [
            Effect(self.physics, f"{form}, only pushing", law, numbers | CLOSED, "friction_force", starts)
            for form, (law, numbers, starts) in laws.items()
            if form in PUSHING
        ]
        return [form for effect in effects for form in pushing_beside(model, joint, effect)]

    def _in_proportion(self) -> Effect:
        """Friction that the joint's own force presses."""
        return Effect(self.physics, "in proportion", "rubbing", SHARE, "friction_share")

    def _finer_in_proportion(self, model: Model, joint: Joint, fastest: float) -> list[Proposal]:
        """The same that falls with the rate; and both where something else presses too."""
        less = falling(fastest)
        # A share that rises with the rate is a rate effect.
        slower = {"stick": evolve(less["stick"], lower=0.0), "stick_rate": less["stick_rate"]}
        pressed, established = self._in_proportion(), smooth(fastest)
        slipping = evolve(pressed, form="in proportion, falling", parameters=SHARE | slower)
        sharp = evolve(slipping, parameters=SHARE | slower | {"slip_rate": less["slip_rate"]})
        preload = Effect(self.physics, "preloaded", "coulomb", FORCE | established | ALWAYS, "friction_force")
        return [
            multiplied(model, joint, sharp),
            _both(model, joint, pressed, preload),
            _both(model, joint, slipping, evolve(preload, parameters=less | established | ALWAYS)),
        ]


def _damper_laws(reached: float, fastest: float) -> ForceLaws:
    """The law of each form, its parameters and starts, in a joint that is deformed so far, m, and so fast, m/s."""
    damping = {"damping": Parameter(0.0, 0.0, 1e7)}
    limit = damping | {"saturating_rate": Parameter(fastest, LEAST_LIMIT * fastest, 10.0 * fastest)}
    rebound = {"exponent": Parameter(1.0, 0.2, 3.0), "rebound": Parameter(1.0, 0.0, 10.0)}
    knee = {"knee_rate": Parameter(0.3 * fastest, 0.01 * fastest, fastest), "beyond": Parameter(0.5, 0.0, 5.0)}
    growing = {"doubling_deformation": Parameter(reached, 0.02 * reached, 50.0 * reached)}
    gradual = {"engagement": Parameter(0.1 * reached, AT_ONCE * reached, reached)}
    lengths = [share * reached for share in COMES_IN]
    return {
        "linear": ("viscous", damping, ({},)),
        CHECKED: ("viscous_power", damping | ONE_WAY, ({},)),
        "power": ("viscous_power", damping | {"exponent": Parameter(0.7, 0.2, 3.0)}, grid(exponent=(0.6, 2.0))),
        "two-way": ("viscous_power", damping | rebound, grid(rebound=(0.4, 2.5))),
        "with a knee": ("viscous_knee", damping | knee, grid(knee_rate=(0.15 * fastest, 0.4 * fastest))),
        "growing with the stroke": ("viscous_growing", damping | growing, ({},)),
        "saturating": ("viscous_saturating", limit, ({},)),
        COMING_IN: ("viscous_saturating", limit | gradual, grid(engagement=lengths)),
    }


def _friction_laws(reached: float, fastest: float) -> ForceLaws:
    """The law of each form, its parameters and starts, in a joint that is deformed so far, m, and so fast, m/s."""
    less, established, lengths = falling(fastest), smooth(fastest), [share * reached for share in BRISTLES]
    bristles = FORCE | {"bristle_length": Parameter(lengths[0], 1e-2 * lengths[1], reached)}
    return {
        "sharp": ("coulomb", FORCE | {"slip_rate": Parameter(0.05, fixed=True)}, ({},)),
        "smooth": ("coulomb", FORCE | established, ({},)),
        "falling": ("coulomb", less, ({},)),
        "smooth and falling": ("coulomb", less | established, ({},)),
        "smooth with a tail": ("coulomb", FORCE | established | TAIL, ({},)),
        "two-way": ("coulomb", FORCE | established | BACK, grid(rebound=(0.5, 2.0))),
        "bristles": ("dahl", bristles, grid(bristle_length=lengths)),
    }


def _may_part(joint: Joint, motion: Sequence[xr.Dataset]) -> bool:
    back = SPRUNG_BACK * largest_deformation(motion, joint.name)
    return largest_extension(motion, joint.name) > 0.0 or largest_recoil(motion, joint.name) > back


def _both(model: Model, joint: Joint, factor: Effect, force: Effect) -> Proposal:
    """A factor on a joint and a force beside it, which are one effect."""
    beside = parallel(model, joint, force)
    both = multiplied(beside.model, joint, factor)
    names, null = (*both.parameters, *beside.parameters), {**both.null, **beside.null}
    return evolve(both, form=f"{factor.form}, {force.form}", parameters=names, null=null)


def _at_times(damping: Effect) -> list[Effect]:
    """While compressed, and where its law knows how, at all times."""
    if damping.form not in FIXED_AT_BOTH_ENDS:
        return [damping]
    parameters = {**damping.parameters, "tension": Parameter(1.0, fixed=True)}
    return [damping, evolve(damping, form=f"{damping.form}, always", parameters=parameters)]
