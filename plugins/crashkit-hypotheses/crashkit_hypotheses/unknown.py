"""A force that no known physics explains, estimated from the recordings as a smooth law."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import xarray as xr

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit_hypotheses.build import largest_deformation, largest_force, largest_rate, parallel

KNOTS = 24
MOST = 2.0
"""Times the largest force of the joint: no height is larger."""
USUAL = 0.02
"""Of the largest force: the size that heights are expected to have. What the joint's own law explains as well is left to that
law, of which more is known outside the runs."""


class Unknown(Hypothesis):
    """F = F_law + f(d), unloading in its own way, or + f(ddot); f a smooth table over the range that the recordings cover."""

    physics: ClassVar[str] = "unknown"
    sentence: ClassVar[str] = "{place} carries a force that none of the known physics explains"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """A force of deformation and one of rate at every joint that is compressed."""
        used = [joint for joint in model.joints if largest_deformation(motion, joint.name) > 0]
        return [form for joint in used for form in self._forms(model, joint, motion)]

    def _forms(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> list[Proposal]:
        largest = max(largest_force(motion, joint.name), 1.0)
        reach, fastest = largest_deformation(motion, joint.name), largest_rate(motion, joint.name)
        of_deformation = {
            "reach": Parameter(reach, fixed=True),
            "unloading_length": Parameter(0.03 * reach, 1e-3 * reach, 2.0 * reach),
        }
        return [
            self._table(model, joint, "deformation", "smooth_table", largest, of_deformation),
            self._table(model, joint, "rate", "rate_table", largest, {"reach": Parameter(fastest, fixed=True)}),
        ]

    def _table(
        self, model: Model, joint: Joint, form: str, law: str, largest: float, more: Mapping[str, Parameter]
    ) -> Proposal:
        height = Parameter(0.0, -MOST * largest, MOST * largest, size=USUAL * largest)
        return parallel(model, joint, self.physics, form, law, {"heights": (height,) * KNOTS, **more}, "heights")
