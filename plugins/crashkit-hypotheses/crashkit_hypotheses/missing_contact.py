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


class MissingContact(Hypothesis):
    """A joint between two bodies that have none: F = k max(0, d - gap)."""

    physics: ClassVar[str] = "missing_contact"
    sentence: ClassVar[str] = "{place} touch, which the model does not know"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every pair of bodies without a joint that come closer than they were."""
        joined = {frozenset(joint.bodies) for joint in model.joints}
        pairs = [(a, b) for a, b in combinations(model.bodies, 2) if not (a.fixed and b.fixed)]
        free = [(a.name, b.name) for a, b in pairs if {a.name, b.name} not in joined and a.position != b.position]
        reached = {pair: largest_approach(motion, *pair) for pair in free}
        return [self._contact(model, pair, reached[pair]) for pair in free if reached[pair] > 1e-3]

    def _contact(self, model: Model, pair: tuple[str, str], reached: float) -> Proposal:
        parameters = {"stiffness": Parameter(0.0, 0.0, 1e10), "stop_deformation": Parameter(0.5 * reached, 0.0, reached)}
        name = fresh_name(f"{pair[0]}_{pair[1]}_contact", (joint.name for joint in model.joints))
        augmented = with_joint(model, Joint(name, pair, "linear_stop", parameters))
        starts = grid(stop_deformation=[share * reached for share in SHARES])
        prefix = f"joint.{name}."
        return proposal(self.physics, "line", {"bodies": list(pair)}, augmented, prefix, parameters, "stiffness", starts)
