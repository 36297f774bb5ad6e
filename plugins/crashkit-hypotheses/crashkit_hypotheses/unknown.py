"""A force that no known physics explains, estimated from the recordings as a smooth law."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import added, largest_deformation, largest_force, largest_rate, parallel

KNOTS = 12


class Unknown(Hypothesis):
    """F = F_law + f(d), or + f(ddot), f a smooth table over the range that the recordings cover."""

    physics: ClassVar[str] = "unknown"
    sentence: ClassVar[str] = "{place} carries a force that none of the known physics explains"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A force of deformation and one of rate at every joint that is compressed."""
        used = [joint for joint in model.joints if largest_deformation(motion, joint.name) > 0]
        return [form for joint in used for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        reach = {"deformation": largest_deformation(motion, joint.name), "rate": largest_rate(motion, joint.name)}
        most = max(largest_force(motion, joint.name), 1.0)
        laws = {"deformation": "smooth_table", "rate": "rate_table"}
        return [self._table(model, joint, form, laws[form], reach[form], 2.0 * most) for form in laws]

    def _table(self, model: Model, joint: Joint, form: str, law: str, reach: float, most: float) -> Proposal:
        table: dict[str, Parameter | tuple[Parameter, ...]] = {
            "heights": tuple(Parameter(0.0, -most, most) for _ in range(KNOTS)),
            "reach": Parameter(reach, fixed=True),
        }
        build = added if form == "deformation" else parallel
        return build(model, joint, self.physics, form, law, table, "heights")
