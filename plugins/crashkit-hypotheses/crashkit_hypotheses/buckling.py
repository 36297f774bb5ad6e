"""A member buckles and folds: a peak of its force, and waves behind it."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, added, grid
from crashkit_hypotheses.sizes import compressed, largest_deformation

BEFORE = 1.6
"""Times the deformation at which the plateau begins: a peak beyond that is none before the plateau."""
PASSED = 0.85
"""Of the deformation reached: a peak that is hardly passed shows as a rise alone, which is no peak."""
FINE = ("pointed", "uneven", "bell", "decaying")
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
FADING = 0.7
"""Logarithm by which each fold may be lower: what loses more than half with every fold does not repeat either."""
SKEW = 0.1
"""To start from: without skew, folds are a sine, which has no derivative to it."""
POINTED = 0.5
"""The same of crests, of which a triangle has 1 and a blunt fold less than 0."""
PHASES = (0.0, -1 / 3, 1 / 3)
"""Where in a fold the first begins, likewise."""


class PeakLoad(Hypothesis):
    """F = F_law + a peak on first loading."""

    physics: ClassVar[str] = "peak_load"
    sentence: ClassVar[str] = "{place} shows a peak of force before its plateau"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A peak at several deformations of every joint that is compressed."""
        return [
            evolve(added(model, joint, effect), refined=effect.form in FINE)
            for joint in compressed(model, motion)
            for effect in self._effects(largest_deformation(motion, joint.name), _plateau(motion, joint.name))
        ]

    def _effects(self, reached: float, plateau: float) -> list[Effect]:
        """Peaks of a joint that is deformed by `reached` and has its plateau from `plateau` on, m."""
        latest = min(BEFORE * plateau, PASSED * reached)
        force, width = Parameter(0.0, 0.0, 1e8), Parameter(0.4 * plateau, 0.01 * plateau, BEFORE * plateau)
        anywhere = {
            "peak_force": force,
            "peak_deformation": Parameter(0.1 * reached, 0.01 * reached, PASSED * reached),
        }
        early = {"peak_force": force, "peak_deformation": Parameter(min(plateau, latest), 0.01 * reached, latest)}
        narrow = early | {"peak_sharpness": Parameter(8.0, 1.0, 200.0)}
        flanked = early | {"peak_width": width}
        dip = {"dip": Parameter(0.3, 0.0, 1.0), "recovery": Parameter(0.2 * reached, 0.01 * reached, reached)}
        shapes = (
            ("narrow", "peak", narrow),
            ("with a dip", "dipping_peak", flanked | dip),
            ("pointed", "pointed_peak", flanked),
            ("uneven", "pointed_peak", flanked | {"peak_rise": width}),
            ("bell", "bell_peak", flanked),
            ("decaying", "decaying_peak", flanked | {"peak_rise": width}),
        )
        starts = grid(peak_deformation=[min(share * plateau, latest) for share in (0.7, 1.0, 1.4)])
        bump = Effect(
            self.physics, "bump", "peak", anywhere, "peak_force", grid(peak_deformation=(0.08 * reached, 0.2 * reached))
        )
        return [bump, *(Effect(self.physics, form, law, own, "peak_force", starts) for form, law, own in shapes)]


class ProgressiveFolding(Hypothesis):
    """F = F_law + a force that oscillates with deformation: a sine, or folds of any shape, that get shorter, longer, lower; or
    with pointed or blunt crests."""

    physics: ClassVar[str] = "progressive_folding"
    sentence: ClassVar[str] = "the force of {place} oscillates with deformation: it folds progressively"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Folds of several lengths at every joint that is compressed."""
        return [form for joint in compressed(model, motion) for form in self._forms(model, joint, motion)]

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
        pointed = {**shaped, "pointedness": Parameter(POINTED, -50.0, 0.99)}
        del pointed["arch"]
        begin = min(plateau, LATEST * reached)
        lengths = [(reached - begin) / number for number in FOLDS]
        starts = [{"fold_length": one, "onset": max(0.0, begin + phase * one)} for phase in PHASES for one in lengths]
        of_one_phase = [start for start in starts[: len(lengths)] if start["fold_length"] < LONGEST_SHAPED * reached]
        return [
            added(model, joint, Effect(self.physics, "sine", "folding", folds, "amplitude", starts)),
            added(model, joint, Effect(self.physics, "shaped", "folding", shaped, "amplitude", of_one_phase)),
            evolve(
                added(model, joint, Effect(self.physics, "pointed", "folding", pointed, "amplitude", of_one_phase)),
                refined=True,
            ),
        ]


def _plateau(motion: Sequence[xr.Dataset], joint: str) -> float:
    """m, deformation at which a joint first carries plainly less than in proportion to its deformation."""
    deepest = max(motion, key=lambda run: float(run["deformation"].sel(joint=joint).max()))
    deformation, force = (deepest[name].sel(joint=joint).values for name in ("deformation", "force"))
    reached = float(np.nanmax(deformation))
    loading = (np.arange(len(force)) <= np.nanargmax(deformation)) & (deformation > FIRST * reached)
    secant = force[loading] / deformation[loading]
    yields = secant < PROPORTIONAL * np.maximum.accumulate(secant)
    return float(deformation[loading][np.argmax(yields)]) if yields.any() else reached
