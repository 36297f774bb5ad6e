"""Forces that act beside a joint's law: damping, friction, a peak, folds."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import added, grid, largest_deformation, parallel

BEFORE = 1.6
"""Times the deformation at which the plateau begins: a peak beyond that is none before the plateau."""
PROPORTIONAL = 0.9
"""Of the largest force per deformation."""
FIRST = 0.02
"""Of the deformation reached: no plateau is taken to begin before."""


class ViscousDamping(Hypothesis):
    """F = F_law + c ddot while the joint is compressed, or F_law + c ddot |ddot|^(n - 1) then, or at all times."""

    physics: ClassVar[str] = "viscous_damping"
    sentence: ClassVar[str] = "{place} is damped: part of its force opposes the deformation rate and grows with it"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed."""
        return [form for joint in _used(model, motion) for form in self._forms(model, joint)]

    def _forms(self, model: Model, joint: Joint) -> list[Proposal]:
        damping = {"damping": Parameter(0.0, 0.0, 1e7)}
        power = {**damping, "exponent": Parameter(0.7, 0.2, 3.0)}
        always = {**power, "tension": Parameter(1.0, fixed=True)}
        starts = grid(exponent=(0.6, 2.0))
        return [
            parallel(model, joint, self.physics, "linear", "viscous", damping, "damping"),
            parallel(model, joint, self.physics, "power", "viscous_power", power, "damping", starts),
            parallel(model, joint, self.physics, "power, always", "viscous_power", always, "damping", starts),
        ]


class JointFriction(Hypothesis):
    """F = F_law + f sign(ddot), smoothed at low rates."""

    physics: ClassVar[str] = "joint_friction"
    sentence: ClassVar[str] = "a dry friction force opposes the deformation of {place}"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint that is compressed: friction that is full at a tenth of a metre per second, or at another rate."""
        force = Parameter(0.0, 0.0, 1e7)
        rates = {"sharp": Parameter(0.05, fixed=True), "smooth": Parameter(0.4, 0.01, 3.0)}
        return [
            parallel(
                model, joint, self.physics, form, "coulomb", {"friction_force": force, "slip_rate": rate}, "friction_force"
            )
            for joint in _used(model, motion)
            for form, rate in rates.items()
        ]


class PeakLoad(Hypothesis):
    """F = F_law + a peak on first loading."""

    physics: ClassVar[str] = "peak_load"
    sentence: ClassVar[str] = "{place} shows a peak of force before its plateau"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A peak at several deformations of every joint that is compressed."""
        return [form for joint in _used(model, motion) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        reached, plateau = largest_deformation(motion, joint.name), _plateau(motion, joint.name)
        peak = {
            "peak_force": Parameter(0.0, 0.0, 1e8),
            "peak_deformation": Parameter(0.1 * reached, 0.01 * reached, reached),
        }
        narrow = {
            "peak_force": Parameter(0.0, 0.0, 1e8),
            "peak_deformation": Parameter(plateau, 0.01 * reached, BEFORE * plateau),
            "peak_sharpness": Parameter(8.0, 1.0, 200.0),
        }
        starts = grid(peak_deformation=(0.08 * reached, 0.2 * reached))
        narrow_starts = grid(peak_deformation=(0.7 * plateau, plateau, 1.4 * plateau))
        return [
            added(model, joint, self.physics, "bump", "peak", peak, "peak_force", starts),
            added(model, joint, self.physics, "narrow", "peak", narrow, "peak_force", narrow_starts),
        ]


class ProgressiveFolding(Hypothesis):
    """F = F_law + a force that oscillates with deformation."""

    physics: ClassVar[str] = "progressive_folding"
    sentence: ClassVar[str] = "the force of {place} oscillates with deformation: it folds progressively"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Folds of several lengths at every joint that is compressed."""
        return [self._folds(model, joint, largest_deformation(motion, joint.name)) for joint in _used(model, motion)]

    def _folds(self, model: Model, joint: Joint, reached: float) -> Proposal:
        folds = {
            "amplitude": Parameter(0.0, 0.0, 1e7),
            "fold_length": Parameter(0.2 * reached, 0.02 * reached, 0.8 * reached),
            "onset": Parameter(0.0, 0.0, 0.8 * reached),
        }
        lengths, onsets = (0.08, 0.12, 0.18, 0.27, 0.4), (0.0, 0.15, 0.4)
        starts = grid(fold_length=[share * reached for share in lengths], onset=[share * reached for share in onsets])
        return added(model, joint, self.physics, "sine", "folding", folds, "amplitude", starts)


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
