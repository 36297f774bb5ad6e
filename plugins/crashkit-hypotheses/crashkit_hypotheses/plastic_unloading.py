"""A joint does not give its energy back."""

from collections.abc import Sequence
from typing import ClassVar

import xarray as xr
from attrs import evolve

from crashkit.model import Joint, Model, Parameter
from crashkit.model.edit import with_changed_joint
from crashkit.protocols import Hypothesis, Proposal
from crashkit.registry import load
from crashkit_hypotheses.build import Effect, changed, grid, multiplied
from crashkit_hypotheses.sizes import gives_all_back, is_compressed, largest_deformation, largest_force

LEVEL = Parameter(1.0, fixed=True)
"""N/m, a slope so small that the joint keeps its largest force on the way back, for a factor to lessen."""
WHOLE = Parameter(1.0, fixed=True)
SLOPE = "unloading_stiffness"
SHARE = Parameter(0.0, 0.0, 1.0)


class PlasticUnloading(Hypothesis):
    """Instead of along its loading curve it unloads along F = F_load(d_max) - k (d_max - d), loses a share on the way back, or
    falls along F = F_load(d_max) ((d - s d_max) / ((1 - s) d_max))^n to a share s of its largest deformation. Or a share of
    the joint does so, along a line or fading, and the rest is elastic; or the line turns less steep from some force on."""

    physics: ClassVar[str] = "plastic_unloading"
    sentence: ClassVar[str] = "{place} unloads along a path of its own and keeps part of its energy"

    def propose(self, model: Model, motion: Sequence[xr.Dataset], recordings: Sequence[xr.DataTree]) -> list[Proposal]:
        """Every joint whose law can unload by its own slope and does not; and, as fading, one that knows no other way back."""
        used = [joint for joint in model.joints if is_compressed(motion, joint.name)]
        plain = (self._line, self._fading, self._set, self._line_of_a_share, self._fading_of_a_share)
        forms = (*plain, self._two_lines, self._two_lines_of_a_share)
        sloped = [form(model, joint, motion) for joint in used if _is_elastic(joint) for form in forms]
        slopeless = [joint for joint in used if SLOPE not in joint.parameters and gives_all_back(motion, joint.name)]
        return [one for one in sloped if one is not None] + [self._fading(model, joint, motion) for joint in slopeless]

    def _line(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        slope, secant = _slope(joint, motion)
        starts = grid(unloading_stiffness=(2.0 * secant, 6.0 * secant, 30.0 * secant))
        line = Effect(self.physics, "line", joint.law, slope, "unloading_stiffness", starts, null=None)
        return changed(model, joint, line)

    def _line_of_a_share(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        slope, secant = _slope(joint, motion)
        starts = grid(unloading_stiffness=(3.0 * secant, 15.0 * secant))
        return _of_a_share(model, joint, Effect(self.physics, "line", joint.law, slope, "unloading_stiffness", starts))

    def _fading(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        length, starts = _length(joint, motion)
        fading = {"loss": SHARE, **length}
        return multiplied(model, joint, Effect(self.physics, "fading", "unloading_loss", fading, "loss", starts))

    def _fading_of_a_share(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        length, starts = _length(joint, motion)
        fading = {"unloading_stiffness": LEVEL, "loss": WHOLE, **length}
        law = f"{joint.law} * unloading_loss"
        return _of_a_share(model, joint, Effect(self.physics, "fading", law, fading, "loss", starts))

    def _two_lines(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        turning = self._turning(joint, motion)
        return evolve(changed(model, joint, turning), refined=True) if turning.law in load().spring_laws else None

    def _two_lines_of_a_share(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal | None:
        told = _of_a_share(model, joint, self._turning(joint, motion))
        return None if told is None else evolve(told, refined=True)

    def _turning(self, joint: Joint, motion: Sequence[xr.Dataset]) -> Effect:
        """Unloading along two lines."""
        slope, secant = _slope(joint, motion)
        lines = {**slope, "turning_share": Parameter(0.5, 0.05, 0.95), "slope_ratio": Parameter(0.3, 0.01, 1.0)}
        starts = grid(unloading_stiffness=(6.0 * secant, 30.0 * secant), slope_ratio=(0.3,))
        law = f"{joint.law} / second_line"
        return Effect(self.physics, "two lines", law, lines, "unloading_stiffness", starts, null=None)

    def _set(self, model: Model, joint: Joint, motion: Sequence[xr.Dataset]) -> Proposal:
        level = with_changed_joint(model, joint.name, parameters={**joint.parameters, "unloading_stiffness": LEVEL})
        back = {
            "residual_share": Parameter(0.3, 0.0, 0.99),
            "unloading_exponent": Parameter(1.2, 1.0, 10.0),
            "loss": WHOLE,
        }
        starts = grid(residual_share=(0.2, 0.5, 0.8))
        residual = Effect(self.physics, "set", "residual_set", back, "residual_share", starts, null=None)
        return multiplied(level, joint, residual)


def _of_a_share(model: Model, joint: Joint, unloading: Effect) -> Proposal | None:
    """The same for a share of the joint, where the law has such a form."""
    law = f"{unloading.law} % plastic_share"
    if law not in load().spring_laws:
        return None
    form, numbers = f"{unloading.form} of a share", {"plastic_share": SHARE, **unloading.parameters}
    starts = [{"plastic_share": 0.3, **start} for start in unloading.starts]
    return changed(model, joint, Effect(unloading.physics, form, law, numbers, "plastic_share", starts))


def _slope(joint: Joint, motion: Sequence[xr.Dataset]) -> tuple[dict[str, Parameter], float]:
    """How steeply it unloads, and the secant of its loading, N/m."""
    secant = max(largest_force(motion, joint.name) / largest_deformation(motion, joint.name), 1e3)
    return {"unloading_stiffness": Parameter(3.0 * secant, 0.1 * secant, 1e3 * secant)}, secant


def _length(joint: Joint, motion: Sequence[xr.Dataset]) -> tuple[dict[str, Parameter], list[dict[str, float]]]:
    """Over which way back the force fades, m, and where to begin."""
    reached = largest_deformation(motion, joint.name)
    length = {"unloading_length": Parameter(0.1 * reached, 1e-3 * reached, 3.0 * reached)}
    return length, grid(unloading_length=[share * reached for share in (0.03, 0.1, 0.4)])


def _is_elastic(joint: Joint) -> bool:
    slope = joint.parameters.get(SLOPE)
    return isinstance(slope, Parameter) and slope.value == 0.0
