"""Viscoelastic memory: part of a joint's force decays with time."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import changed, grid, largest_deformation, largest_force, multiplied, parallel

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
        used = [joint for joint in model.joints if largest_deformation(motion, joint.name) > 0]
        return [form for joint in used for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        duration = max(float(one["time"].values[-1]) for one in motion)
        trace = TRACE * largest_force(motion, joint.name) / largest_deformation(motion, joint.name)
        time = Parameter(TIME_SHARES[0] * duration, 1e-3, 10.0 * duration)
        times = [share * duration for share in TIME_SHARES]
        element = {
            "relaxing_stiffness": Parameter(0.0, 0.0, 1e9),
            "relaxation_time": time,
            "clearance": Parameter(0.0, fixed=True),
            "tension": Parameter(0.0, fixed=True),
        }
        maxwell = [
            form
            for holding, holds in (("", 0.0), (", holding", 1.0))
            for form in _branches(
                model, joint, self.physics, holding, {**element, "holds": Parameter(holds, fixed=True)}, trace, times
            )
        ]
        if "fading" in joint.factors:
            return maxwell
        fading = {"fading_share": Parameter(0.0, 0.0, 1.0), "relaxation_time": time}
        share = multiplied(model, joint, self.physics, "fading", "fading", fading, "fading_share", grid(relaxation_time=times))
        return [*maxwell, share, *_quasi_linear(model, joint, self.physics, time, times)]


def _branches(
    model: Model,
    joint: Joint,
    physics: str,
    holding: str,
    element: Mapping[str, Parameter],
    trace: float,
    times: Sequence[float],
) -> list[Proposal]:
    """One element, and two: the first terms of a Prony series."""

    def beside(what: Model, form: str, first: Sequence[float]) -> Proposal:
        starts = grid(relaxing_stiffness=(trace,), relaxation_time=first)
        return parallel(what, joint, physics, form, "maxwell", element, "relaxing_stiffness", starts)

    one = beside(model, f"maxwell{holding}", times)
    short, long = beside(model, "", times[:1]), beside(one.model, f"two branches{holding}", times[1:])
    both = evolve(
        long,
        parameters=(*short.parameters, *long.parameters),
        null={**short.null, **long.null},
        starts=({**short.starts[0], **long.starts[0]},),
        refined=True,
    )
    return [one, both]


def _quasi_linear(model: Model, joint: Joint, physics: str, time: Parameter, times: Sequence[float]) -> list[Proposal]:
    """Where the joint's law can pass through a memory."""
    law = f"{joint.law} ~ quasi_linear"
    if law not in load().spring_laws:
        return []
    through, starts = evolve(joint, law=law), grid(relaxation_time=times)
    fresh = {"fresh_share": Parameter(0.0, 0.0, 1e2), "relaxation_time": time}
    return [
        changed(model, through, physics, form, {**fresh, "holds": Parameter(holds, fixed=True)}, "fresh_share", starts)
        for form, holds in (("quasi-linear", 0.0), ("quasi-linear, holding", 1.0))
    ]
