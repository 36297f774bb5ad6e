"""A joint does not give its energy back."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import changed, grid, largest_deformation, largest_force, multiplied

LEVEL = Parameter(1.0, fixed=True)
"""N/m, a slope so small that the joint keeps its largest force on the way back, for a factor to lessen."""
WHOLE = Parameter(1.0, fixed=True)
SHARE = Parameter(0.0, 0.0, 1.0)


class PlasticUnloading(Hypothesis):
    """Instead of along its loading curve it unloads along F = F_load(d_max) - k (d_max - d), loses a share on the way back, or
    falls along F = F_load(d_max) ((d - s d_max) / ((1 - s) d_max))^n to a share s of its largest deformation. Or a share of
    the joint does so, along a line or fading, and the rest is elastic; or the line turns less steep from some force on."""

    physics: ClassVar[str] = "plastic_unloading"
    sentence: ClassVar[str] = "{place} unloads along a path of its own and keeps part of its energy"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law can unload by its own slope and does not."""
        elastic = [joint for joint in model.joints if _is_elastic(joint)]
        used = [joint for joint in elastic if largest_deformation(motion, joint.name) > 0]
        plain = (self._line, self._fading, self._set, self._line_of_a_share, self._fading_of_a_share)
        forms = (*plain, self._two_lines, self._two_lines_of_a_share)
        return [one for joint in used for form in forms if (one := form(model, joint, motion)) is not None]

    def _line(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        slope, secant = _slope(joint, motion)
        starts = grid(unloading_stiffness=(2.0 * secant, 6.0 * secant, 30.0 * secant))
        return changed(model, joint, self.physics, "line", slope, "unloading_stiffness", starts, null=None)

    def _line_of_a_share(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        slope, secant = _slope(joint, motion)
        starts = grid(plastic_share=(0.3,), unloading_stiffness=(3.0 * secant, 15.0 * secant))
        return self._of_a_share(model, joint, joint.law, "line of a share", slope, starts)

    def _fading(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        length, starts = _length(joint, motion)
        fading = {"loss": SHARE, **length}
        return multiplied(model, joint, self.physics, "fading", "unloading_loss", fading, "loss", starts)

    def _fading_of_a_share(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        length, starts = _length(joint, motion)
        numbers = {"unloading_stiffness": LEVEL, "loss": WHOLE, **length}
        shares = [{"plastic_share": 0.3, **start} for start in starts]
        return self._of_a_share(model, joint, f"{joint.law} * unloading_loss", "fading of a share", numbers, shares)

    def _two_lines(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        law, numbers, starts = _turning(joint, motion)
        if law not in load().spring_laws:
            return None
        turning = evolve(joint, law=law)
        told = changed(model, turning, self.physics, "two lines", numbers, "unloading_stiffness", starts, null=None)
        return evolve(told, refined=True)

    def _two_lines_of_a_share(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        law, numbers, starts = _turning(joint, motion)
        shares = [{"plastic_share": 0.3, **start} for start in starts]
        told = self._of_a_share(model, joint, law, "two lines of a share", numbers, shares)
        return None if told is None else evolve(told, refined=True)

    def _of_a_share(
        self,
        model: Model,
        joint: Joint,
        law: str,
        form: str,
        numbers: dict[str, Parameter],
        starts: list[dict[str, float]],
    ) -> Proposal | None:
        """A law for a share of the joint, where the two fit together."""
        name = f"{law} % plastic_share"
        if name not in load().spring_laws:
            return None
        numbers = {"plastic_share": SHARE, **numbers}
        return changed(model, evolve(joint, law=name), self.physics, form, numbers, "plastic_share", starts)

    def _set(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        level = evolve(joint, parameters={**joint.parameters, "unloading_stiffness": LEVEL})
        unloading = evolve(model, joints=tuple(level if j.name == joint.name else j for j in model.joints))
        back = {
            "residual_share": Parameter(0.3, 0.0, 0.99),
            "unloading_exponent": Parameter(1.2, 1.0, 10.0),
            "loss": WHOLE,
        }
        starts = grid(residual_share=(0.2, 0.5, 0.8))
        one = multiplied(unloading, level, self.physics, "set", "residual_set", back, "residual_share", starts)
        return evolve(one, null={})


def _slope(joint: Joint, motion: Sequence[xr.Dataset]) -> tuple[dict[str, Parameter], float]:
    """How steeply it unloads, and the secant of its loading, N/m."""
    secant = max(largest_force(motion, joint.name) / largest_deformation(motion, joint.name), 1e3)
    return {"unloading_stiffness": Parameter(3.0 * secant, 0.1 * secant, 1e3 * secant)}, secant


def _turning(joint: Joint, motion: Sequence[xr.Dataset]) -> tuple[str, dict[str, Parameter], list[dict[str, float]]]:
    """A law that unloads along two lines, its numbers, and where to begin."""
    slope, secant = _slope(joint, motion)
    numbers = {**slope, "turning_share": Parameter(0.5, 0.05, 0.95), "slope_ratio": Parameter(0.3, 0.01, 1.0)}
    return f"{joint.law} / second_line", numbers, grid(unloading_stiffness=(6.0 * secant, 30.0 * secant), slope_ratio=(0.3,))


def _length(joint: Joint, motion: Sequence[xr.Dataset]) -> tuple[dict[str, Parameter], list[dict[str, float]]]:
    """Over which way back the force fades, m, and where to begin."""
    reached = largest_deformation(motion, joint.name)
    length = {"unloading_length": Parameter(0.1 * reached, 1e-3 * reached, 3.0 * reached)}
    return length, grid(unloading_length=[share * reached for share in (0.03, 0.1, 0.4)])


def _is_elastic(joint: Joint) -> bool:
    slope = joint.parameters.get("unloading_stiffness")
    return isinstance(slope, Parameter) and slope.value == 0.0
