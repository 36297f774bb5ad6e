"""Viscoelastic memory: part of a joint's force decays with time."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import Effect, changed, grid, multiplied, parallel, pushing_beside
from crashkit_hypotheses.sizes import compressed, duration, largest_deformation, largest_force

TIME_SHARES = (0.05, 0.3)
"""Relaxation times to start from, in durations of a run: shorter ones are dashpots, longer ones springs."""

TRACE = 1e-3
"""Stiffness to start from, relative to the joint's own: at 0 the element's force is on its corner, and has no slope."""


class Relaxation(Hypothesis):
    """F = F_law + k (d - q), q' = (d - q) / tau (Maxwell), two such elements, or a share of the law's own force that fades.

    All of it at once, F = F_law (1 - s m), m' = (1 - m) / tau under load, or each of its changes by itself (quasi-linear),
    F = F_law + s (F_law - q), q' = (F_law - q) / tau.
    """

    physics: ClassVar[str] = "relaxation"
    sentence: ClassVar[str] = "part of the force of {place} decays with time"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A Maxwell element beside every joint that is compressed; a share of its own force, or of its changes, that fades."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        longest = duration(motion)
        time = Parameter(TIME_SHARES[0] * longest, 1e-3, 10.0 * longest)
        times = [share * longest for share in TIME_SHARES]
        trace = TRACE * largest_force(motion, joint.name) / largest_deformation(motion, joint.name)
        maxwell = self._maxwell(model, joint, time, grid(relaxing_stiffness=(trace,), relaxation_time=times))
        if "fading" in joint.factors:
            return maxwell
        share = {"fading_share": Parameter(0.0, 0.0, 1.0), "relaxation_time": time}
        fading = Effect(self.physics, "fading", "fading", share, "fading_share", grid(relaxation_time=times))
        return [*maxwell, multiplied(model, joint, fading), *self._quasi_linear(model, joint, time, times)]

    def _maxwell(self, model: Model, joint: Joint, time: Parameter, starts: list[dict[str, float]]) -> list[Proposal]:
        """One element, and two; which may pull while the joint is compressed, or not, or as far as the joint still pushes."""
        parameters = {
            "relaxing_stiffness": Parameter(0.0, 0.0, 1e9),
            "relaxation_time": time,
            "clearance": Parameter(0.0, fixed=True),
            "tension": Parameter(0.0, fixed=True),
        }
        forms = []
        for holding, holds in (("", 0.0), (", holding", 1.0)):
            own = {**parameters, "holds": Parameter(holds, fixed=True)}
            element = Effect(self.physics, f"maxwell{holding}", "maxwell", own, "relaxing_stiffness", starts)
            branches = evolve(element, form=f"two branches{holding}")
            forms += [parallel(model, joint, element), _two_branches(model, joint, branches)]
        pushing = pushing_beside(model, joint, evolve(element, form="maxwell, only pushing"))
        return [*forms, *(evolve(form, refined=True) for form in pushing)]

    def _quasi_linear(self, model: Model, joint: Joint, time: Parameter, times: Sequence[float]) -> list[Proposal]:
        """Where the joint's law can pass through a memory."""
        law = f"{joint.law} ~ quasi_linear"
        if law not in load().spring_laws:
            return []
        fresh, starts = {"fresh_share": Parameter(0.0, 0.0, 1e2), "relaxation_time": time}, grid(relaxation_time=times)
        effects = [
            Effect(self.physics, form, law, {**fresh, "holds": Parameter(holds, fixed=True)}, "fresh_share", starts)
            for form, holds in (("quasi-linear", 0.0), ("quasi-linear, holding", 1.0))
        ]
        return [changed(model, joint, effect) for effect in effects]


def _two_branches(model: Model, joint: Joint, element: Effect) -> Proposal:
    """The element twice, each from a start of its own: the first terms of a Prony series."""
    short = parallel(model, joint, evolve(element, starts=element.starts[:1]))
    long = parallel(short.model, joint, evolve(element, starts=element.starts[1:]))
    return evolve(
        long,
        parameters=(*short.parameters, *long.parameters),
        null={**short.null, **long.null},
        starts=({**short.starts[0], **long.starts[0]},),
        refined=True,
    )
