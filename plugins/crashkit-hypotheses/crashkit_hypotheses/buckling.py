"""A member buckles and folds: a peak of its force, and waves behind it."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, added, beside, grid, multiplied
from crashkit_hypotheses.sizes import compressed, largest_deformation, of_joint

FORCE = Parameter(0.0, 0.0, 1e8)
BEFORE = 2.5
"""Times the deformation at which the plateau begins: a peak beyond that is none before the plateau. One that the model lacks
drives its stiffness up, and its plateau then seems to begin early."""
PASSED = 0.85
"""Of the deformation reached: a peak that is hardly passed shows as a rise alone, which is no peak."""
FINE = ("pointed", "uneven", "bell", "arched", "decaying")
"""Shapes of a peak that have simpler ones which stand in for them."""
PROPORTIONAL = 0.9
"""Of the largest force per deformation."""
FIRST = 0.02
"""Of the deformation reached: no plateau is taken to begin before."""
LATEST, LAST = 0.3, 0.5
"""Of the deformation reached: folds are looked for from there at the latest, and none begin later."""
FOLDS = (2.0, 2.75, 3.5, 4.5, 5.5, 6.5, 8.0, 10.0, 12.5)
"""How many folds to start from: a search only finds the number that is nearest."""
LONGEST, LONGEST_SHAPED = 0.5, 0.4
"""Of the deformation reached: what is longer does not repeat. It could be any force, above all in folds of any shape."""
SKEWED = {"skew": Parameter(0.1, -0.98, 0.98)}
"""Started from some skew: without it, folds are a sine, which has no derivative to it."""
ARCHED = {"arch": Parameter(0.1, 0.0, 0.95)}
FADING = 0.7
"""Logarithm by which each fold may be lower: what loses more than half with every fold does not repeat either."""
VARYING = {"shortening": Parameter(0.0, -0.3, 0.5), "weakening": Parameter(0.01, 0.0, FADING)}
POINTED = {"pointedness": Parameter(0.5, -50.0, 0.99)}
"""Of crests: a triangle has 1 and a blunt fold less than 0."""
RELEASED = "bell"
"""The shape that a peak may also release by itself."""
PHASES = (0.0, -1 / 3, 1 / 3)
"""Where in a fold the first begins, to start from."""


class PeakLoad(Hypothesis):
    """F = F_law + a peak on first loading, which is released with the law or by itself."""

    physics: ClassVar[str] = "peak_load"
    sentence: ClassVar[str] = "{place} shows a peak of force before its plateau"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A peak at several deformations of every joint that is compressed."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        effects = self._effects(largest_deformation(motion, joint.name), _plateau(motion, joint.name))
        own = [form for effect in effects if effect.form == RELEASED for form in beside(model, joint, effect)]
        return [*(evolve(added(model, joint, effect), refined=effect.form in FINE) for effect in effects), *own]

    def _effects(self, reached: float, plateau: float) -> list[Effect]:
        """Peaks of a joint that is deformed by `reached` and has its plateau from `plateau` on, m."""
        latest = min(BEFORE * plateau, PASSED * reached)
        anywhere = {
            "peak_force": FORCE,
            "peak_deformation": Parameter(0.1 * reached, 0.01 * reached, PASSED * reached),
        }
        bumps = grid(peak_deformation=(0.08 * reached, 0.2 * reached))
        starts = grid(peak_deformation=[min(share * plateau, latest) for share in (0.7, 1.0, 1.4)])
        return [
            Effect(self.physics, "bump", "peak", anywhere, "peak_force", bumps),
            *(
                Effect(self.physics, form, law, own, "peak_force", starts)
                for form, law, own in _shapes(reached, plateau, latest)
            ),
        ]


def _shapes(reached: float, plateau: float, latest: float) -> list[tuple[str, str, dict[str, Parameter]]]:
    """Form, law and parameters of the peaks that come before the plateau."""
    early = {"peak_force": FORCE, "peak_deformation": Parameter(min(plateau, latest), 0.01 * reached, latest)}
    width = Parameter(0.4 * plateau, 0.01 * plateau, BEFORE * plateau)
    flanked = early | {"peak_width": width}
    dip = {"dip": Parameter(0.3, 0.0, 1.0), "recovery": Parameter(0.2 * reached, 0.01 * reached, reached)}
    return [
        ("narrow", "peak", early | {"peak_sharpness": Parameter(8.0, 1.0, 200.0)}),
        ("with a dip", "dipping_peak", flanked | dip),
        ("pointed", "pointed_peak", flanked),
        ("uneven", "pointed_peak", flanked | {"peak_rise": width}),
        ("bell", "bell_peak", flanked),
        ("arched", "arched_peak", flanked | {"peak_power": Parameter(1.5, 1.0, 2.0)}),
        ("decaying", "decaying_peak", flanked | {"peak_rise": width}),
    ]


class ProgressiveFolding(Hypothesis):
    """F = F_law + a force that oscillates with deformation: a sine, or folds of any shape, that get shorter, longer, lower; or
    with pointed or blunt crests; released with the law or by itself. Or F_law (1 + a share that oscillates so)."""

    physics: ClassVar[str] = "progressive_folding"
    sentence: ClassVar[str] = "the force of {place} oscillates with deformation: it folds progressively"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Folds of several lengths at every joint that is compressed."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        reached = largest_deformation(motion, joint.name)
        starts = _starts(reached, _plateau(motion, joint.name))
        folds, shaped = _folds(reached, LONGEST), _folds(reached, LONGEST_SHAPED) | SKEWED
        of_one_phase = [start for start in starts[: len(FOLDS)] if start["fold_length"] < LONGEST_SHAPED * reached]
        sine = Effect(self.physics, "sine", "folding", folds, "amplitude", starts)
        arched = Effect(self.physics, "shaped", "folding", shaped | ARCHED | VARYING, "amplitude", of_one_phase)
        pointed = evolve(arched, form="pointed", parameters=shaped | VARYING | POINTED)
        few = of_one_phase[::3]
        numbers = {"fold_share": Parameter(0.0, 0.0, 0.5), **_lengths(reached, LONGEST_SHAPED), **SKEWED, **POINTED}
        share = Effect(self.physics, "in proportion", "folding_share", numbers, "fold_share", few)
        plain = [added(model, joint, effect) for effect in (sine, arched)]
        fine = [added(model, joint, pointed), multiplied(model, joint, share)]
        return [*plain, *(evolve(form, refined=True) for form in fine), *beside(model, joint, evolve(arched, starts=few))]


def _folds(reached: float, longest: float) -> dict[str, Parameter]:
    """Of a joint that is deformed so far, m; none is longer than this share of it."""
    return {"amplitude": Parameter(0.0, 0.0, 1e7), **_lengths(reached, longest)}


def _lengths(reached: float, longest: float) -> dict[str, Parameter]:
    return {
        "fold_length": Parameter(0.2 * reached, 0.02 * reached, longest * reached),
        "onset": Parameter(0.0, 0.0, LAST * reached),
    }


def _starts(reached: float, plateau: float) -> list[dict[str, float]]:
    """Every number of folds from the plateau on, in every phase."""
    begin = min(plateau, LATEST * reached)
    lengths = [(reached - begin) / number for number in FOLDS]
    return [{"fold_length": one, "onset": max(0.0, begin + phase * one)} for phase in PHASES for one in lengths]


def _plateau(motion: Sequence[xr.Dataset], joint: str) -> float:
    """m, deformation at which a joint first carries plainly less than in proportion to its deformation."""
    deepest = max(motion, key=lambda run: float(of_joint(run, "deformation", joint).max()))
    deformation, force = (of_joint(deepest, name, joint) for name in ("deformation", "force"))
    reached = float(np.nanmax(deformation))
    loading = (np.arange(len(force)) <= np.nanargmax(deformation)) & (deformation > FIRST * reached)
    secant = force[loading] / deformation[loading]
    yields = secant < PROPORTIONAL * np.maximum.accumulate(secant)
    return float(deformation[loading][np.argmax(yields)]) if yields.any() else reached
