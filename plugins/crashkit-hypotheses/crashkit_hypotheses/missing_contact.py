"""Two bodies touch that the model does not join."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.model import Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import Effect, Table, between, grid
from crashkit_hypotheses.sizes import approaching

LINE = (0.1, 0.4, 0.6, 0.8, 0.93)
"""Gaps to start from, relative to the approach."""
STIFFENING = (0.05, 0.4, 0.7)
"""The same of a contact that stiffens: it may begin early and still be felt late."""
CRUSHED, LENGTHS = (0.3, 0.6, 0.85), (0.05, 0.5)
"""The same of one that is crushed, and the way over which its force rises."""
LOSS = 0.2
"""s/m, of one that takes up energy as it is struck, to start from."""
RUBBING = {"friction_share": Parameter(0.3, 0.0, 1.0), "slip_rate": Parameter(0.1, 1e-3, 1.0)}
"""Of one that gives back less than it took, each time."""
RELEASE = 5.0
"""Its slope on the way back, relative to that on the way in, to start from."""
LEVELS = (0.1, 0.4)
"""Forces of a member to start from, relative to the largest in a model's own."""
DENSE, CORNERS = 0.7, (0.03, 0.3)
"""Where a plateau ends, and where a rising member yields and stiffens, to start from, relative to the approach: in a search
numbers of a list go not quite half way to their neighbours."""


class MissingContact(Hypothesis):
    """A joint between two bodies that have none: F = k x, c x^2, P x^n (1 + c ddot) or k x + c ddot, x = max(0, d - gap), or
    one crushed, to a plateau or to densification beyond it, which may rise to it; or P x^n that rubs."""

    physics: ClassVar[str] = "missing_contact"
    sentence: ClassVar[str] = "{place} touch, which the model does not know"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every pair of bodies without a joint that come closer than they were."""
        force = max(float(np.nanmax(np.abs(one["force"].values), initial=1.0)) for one in motion)
        pairs = approaching(model, motion).items()
        return [
            form
            for pair, reached in pairs
            for form in (
                *self._forms(model, pair, reached),
                self._with_dashpot(model, pair, reached),
                self._rubbing(model, pair, reached),
                *self._members(model, pair, reached, force),
            )
        ]

    def _forms(self, model: Model, pair: tuple[str, str], reached: float) -> list[Proposal]:
        gap = _gap(reached)
        line = {"stiffness": Parameter(0.0, 0.0, 1e10)}
        parabola = {"coefficient": Parameter(0.0, 0.0, 1e12)}
        crushed = {
            **line,
            "crush_length": Parameter(0.5 * reached, 1e-3 * reached, 10.0 * reached),
            "release": Parameter(RELEASE, 1.0, 1e3),
        }
        damped = _power(reached) | {"loss": Parameter(LOSS, 0.0, 10.0)}
        engaging, stiffening = _starts(reached, stop_deformation=LINE), _starts(reached, stop_deformation=STIFFENING)
        crushing = _starts(reached, stop_deformation=CRUSHED, crush_length=LENGTHS)
        effects = (
            Effect(self.physics, "line", "linear_stop", line | gap, "stiffness", engaging),
            Effect(self.physics, "parabola", "quadratic_stop", parabola | gap, "coefficient", stiffening),
            Effect(self.physics, "damped", "hunt_crossley", damped | gap, "force", stiffening),
            Effect(self.physics, "crushed", "crush_stop", crushed | gap, "stiffness", crushing),
        )
        return [between(model, pair, effect) for effect in effects]

    def _with_dashpot(self, model: Model, pair: tuple[str, str], reached: float) -> Proposal:
        """max(0, k x + c ddot): both act from the first touch on."""
        numbers = {"stiffness": Parameter(0.0, 0.0, 1e10), "damping": Parameter(0.0, 0.0, 1e7)} | _gap(reached)
        starts = _starts(reached, stop_deformation=LINE)
        effect = Effect(self.physics, "with a dashpot", "damped_stop", numbers, "stiffness", starts)
        return evolve(between(model, pair, effect), refined=True)

    def _rubbing(self, model: Model, pair: tuple[str, str], reached: float) -> Proposal:
        """P x^n (1 + share tanh(ddot / slip_rate)): of what it takes, a share never comes back."""
        starts = _starts(reached, stop_deformation=STIFFENING)
        rubbing = _power(reached) | _gap(reached) | RUBBING
        effect = Effect(self.physics, "power, rubbing", "power_stop", rubbing, "force", starts)
        return between(model, pair, effect, ("rubbing",))

    def _members(self, model: Model, pair: tuple[str, str], reached: float, force: float) -> list[Proposal]:
        """A whole member between the two, as a model's own are: elastic, a plateau or a slope, densification, behind a gap.

        Arguments:
            force: N, the largest in the model's own joints.
        """
        effects = (_plateau(self.physics, reached, force), _rising(self.physics, reached, force))
        return [evolve(between(model, pair, effect), refined=True) for effect in effects]


def _plateau(physics: str, reached: float, force: float) -> Effect:
    slope = _slope(reached, force)
    numbers: Table = {
        "elastic_stiffness": slope,
        "crush_force": _level(force),
        "densification_deformation": _way(DENSE, reached),
        "densification_stiffness": slope,
        **_ends(reached, force),
    }
    starts = grid(clearance=_gaps(reached), crush_force=[share * force for share in LEVELS])
    return Effect(physics, "member", "crush_plateau", numbers, "crush_force", starts, null=None)


def _rising(physics: str, reached: float, force: float) -> Effect:
    numbers: Table = {
        "force": (_level(force),) * 2,
        "deformation": tuple(_way(corner, reached) for corner in CORNERS),
        "final_stiffness": _slope(reached, force),
        **_ends(reached, force),
    }
    levels = [{"force[0]": share * force, "force[1]": 2.0 * share * force} for share in LEVELS]
    starts = [{"clearance": gap, **level} for gap in _gaps(reached) for level in levels]
    return Effect(physics, "member, rising", "piecewise_affine", numbers, "force", starts, null=None)


def _ends(reached: float, force: float) -> dict[str, Parameter]:
    """Where a member begins, and how steeply it lets go."""
    steep = evolve(_slope(reached, force), value=20.0 * force / reached)
    return {"unloading_stiffness": steep, "clearance": Parameter(0.3 * reached, 0.0, reached)}


def _slope(reached: float, force: float) -> Parameter:
    return Parameter(5.0 * force / reached, 1e-3 * force / reached, 1e4 * force / reached)


def _level(force: float) -> Parameter:
    return Parameter(0.3 * force, 1e-4 * force, 10.0 * force)


def _way(share: float, reached: float) -> Parameter:
    return Parameter(share * reached, 1e-3 * reached, 10.0 * reached)


def _gaps(reached: float) -> list[float]:
    return [share * reached for share in LINE[:4]]


def _gap(reached: float) -> dict[str, Parameter]:
    return {"stop_deformation": Parameter(0.5 * reached, 0.0, reached)}


def _power(reached: float) -> dict[str, Parameter]:
    return {
        "force": Parameter(0.0, 0.0, 1e9),
        "exponent": Parameter(1.5, 1.0, 4.0),
        "way": Parameter(0.1 * reached, fixed=True),
    }


def _starts(reached: float, **shares: Sequence[float]) -> list[dict[str, float]]:
    """Every combination of lengths that are shares of the approach."""
    return grid(**{length: [share * reached for share in each] for length, each in shares.items()})
