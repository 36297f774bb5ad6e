"""Two bodies touch that the model does not join."""

from collections.abc import Sequence
from itertools import combinations
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.model.edit import fresh_name, with_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import grid, largest_approach, proposal

SHARES = (0.1, 0.4, 0.6, 0.8, 0.93)
FEWER = (0.05, 0.4, 0.7)
"""Gaps of a contact that stiffens, relative to the approach: it may begin early and still be felt late."""


class MissingContact(Hypothesis):
    """A joint between two bodies that have none: F = k max(0, d - gap), or c max(0, d - gap)^2."""

    physics: ClassVar[str] = "missing_contact"
    sentence: ClassVar[str] = "{place} touch, which the model does not know"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every pair of bodies without a joint that come closer than they were."""
        joined = {frozenset(joint.bodies) for joint in model.joints}
        pairs = [(a, b) for a, b in combinations(model.bodies, 2) if not (a.fixed and b.fixed)]
        free = [(a.name, b.name) for a, b in pairs if {a.name, b.name} not in joined and a.position != b.position]
        reached = {pair: largest_approach(motion, *pair) for pair in free}
        near = [pair for pair in free if reached[pair] > 1e-3]
        return [form for pair in near for form in self._forms(model, pair, reached[pair])]

    def _forms(self, model: Model, pair: tuple[str, str], reached: float) -> list[Proposal]:
        line = {"stiffness": Parameter(0.0, 0.0, 1e10)}
        parabola = {"coefficient": Parameter(0.0, 0.0, 1e12)}
        return [
            self._contact(model, pair, reached, "line", "linear_stop", line, SHARES),
            self._contact(model, pair, reached, "parabola", "quadratic_stop", parabola, FEWER),
        ]

    def _contact(
        self,
        model: Model,
        pair: tuple[str, str],
        reached: float,
        form: str,
        law: str,
        amplitude: dict[str, Parameter],
        shares: Sequence[float],
    ) -> Proposal:
        parameters = {**amplitude, "stop_deformation": Parameter(0.5 * reached, 0.0, reached)}
        name = fresh_name(f"{pair[0]}_{pair[1]}_contact", (joint.name for joint in model.joints))
        augmented = with_joint(model, Joint(name, pair, law, parameters))
        starts = grid(stop_deformation=[share * reached for share in shares])
        prefix = f"joint.{name}."
        first = next(iter(amplitude))
        return proposal(self.physics, form, {"bodies": list(pair)}, augmented, prefix, parameters, first, starts)
