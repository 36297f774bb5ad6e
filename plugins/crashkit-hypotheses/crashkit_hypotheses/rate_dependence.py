"""A joint's force level rises with its deformation rate."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, Table, grid, multiplied
from crashkit_hypotheses.sizes import largest_rate

LINEAR = {"rate_slope": Parameter(0.0, 0.0, 1.0)}
POWER = {"rate_amplitude": Parameter(0.0, 0.0, 10.0), "rate_exponent": Parameter(0.3, 0.05, 2.0)}
LOGARITHM = {"rate_amplitude": Parameter(0.0, 0.0, 10.0), "reference_rate": Parameter(0.5, 1e-3, 20.0)}
SHARPNESS = {"limit_sharpness": Parameter(2.0, 1.0, 10.0)}
STEPS = 8
"""Of a rise that may have any shape."""
SLOWEST = 0.1
"""Reference rate, of the fastest there was, of an effect that has a limit: one that is reached at once is friction."""


class RateDependence(Hypothesis):
    """F = F_static (1 + a ddot), F_static (1 + a ddot^n) (Cowper-Symonds) or F_static (1 + a ln(1 + ddot / r)) (Johnson-Cook).

    Mizzi & Jezequel 1992, eq 1, for the linear form. Where it has a limit, F_static (1 + a ddot / (ddot^n + r^n)^(1 / n)), n
    1 or more; where it also falls on the way back, F_static (1 + a asinh(ddot / r)); and in steps, which make up any rise.
    """

    physics: ClassVar[str] = "rate_dependence"
    sentence: ClassVar[str] = "the force of {place} rises with its deformation rate"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Several forms at every joint that has no rate factor yet."""
        return [form for joint in model.joints if not _has_rate(joint) for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        fastest = largest_rate(motion, joint.name)
        slowest = min(max(SLOWEST * fastest, 1e-3), 1.0)
        limited = LOGARITHM | {"reference_rate": Parameter(max(0.5, slowest), slowest, 20.0)}
        steps: Table = {
            "rises": (Parameter(0.0, 0.0, 10.0),) * STEPS,
            "rising_reach": Parameter(max(fastest, 1e-3), fixed=True),
        }
        powers = grid(rate_exponent=(0.2, 0.6))
        plain = (
            Effect(self.physics, "linear", "rate_linear", LINEAR, "rate_slope"),
            Effect(self.physics, "power", "rate_power", POWER, "rate_amplitude", powers),
            Effect(self.physics, "logarithm", "rate_logarithm", LOGARITHM, "rate_amplitude"),
        )
        fine = (
            Effect(self.physics, "to a limit", "rate_saturating", limited, "rate_amplitude"),
            Effect(self.physics, "to a limit, sharply", "rate_saturating", limited | SHARPNESS, "rate_amplitude"),
            Effect(self.physics, "both ways", "rate_eyring", LOGARITHM, "rate_amplitude"),
            Effect(self.physics, "in steps", "rate_rising", steps, "rises"),
        )
        return [
            *(multiplied(model, joint, effect) for effect in plain),
            *(evolve(multiplied(model, joint, effect), refined=True) for effect in fine),
        ]


def _has_rate(joint: Joint) -> bool:
    return any(factor.startswith("rate_") for factor in joint.factors)
