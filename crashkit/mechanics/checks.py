"""What a run may be asked for; told where a user asks, never where a search does."""

import math
from collections.abc import Mapping

import numpy as np
from attrs import frozen
from numpy.typing import ArrayLike

from crashkit.data.validate import shown
from crashkit.errors import CrashkitError
from crashkit.mechanics.kernel.arrays import Floats
from crashkit.mechanics.layout import Layout
from crashkit.model import Model, Parameter
from crashkit.model.value_checks import check_values


@frozen
class Allowed:
    """The values that may be given to the runs of a model.

    Arguments:
        source: how errors name the model.
        known: by path, everything that a run takes, with its bounds.
        absent: by path, values at which the physics is absent, which may lie outside the bounds.
    """

    source: str
    known: Mapping[str, Parameter]
    absent: Mapping[str, tuple[float | None, ...]]

    @classmethod
    def of(cls, model: Model, layout: Layout) -> "Allowed":
        """What the model and its laws declare; a state at t = 0 and a point have no bounds."""
        specs = layout.declared()
        declared = {path: Parameter(math.nan, spec.lower, spec.upper) for path, spec in specs.items()}
        known = dict.fromkeys(layout.places, Parameter(math.nan)) | declared | model.parameters()
        return cls(f"model {model.name}", known, {path: (spec.null, spec.default) for path, spec in specs.items()})

    def check(self, values: Mapping[str, float]) -> None:
        """Raises CrashkitError for values that are not finite, out of their bounds, or a mass that is not above 0."""
        check_values(values, self.known, self.source, self.absent)


def check_step(step: float) -> float:
    """A step as a number; raises CrashkitError for one with which no run would end."""
    if not (isinstance(step, int | float | np.number) and 0.0 < step < math.inf):
        raise CrashkitError(f"step: expected a positive number of seconds, found {shown(step)}")
    return float(step)


def checked_times(times: ArrayLike) -> Floats:
    """Times as an array; raises CrashkitError for what cannot be used."""
    try:
        instants = np.ascontiguousarray(times, dtype=float)
    except (TypeError, ValueError) as error:
        raise CrashkitError(f"times: expected numbers, found {type(times).__name__} that is none: {error}") from error
    if instants.ndim != 1 or instants.size == 0:
        raise CrashkitError(f"times: expected at least one, in one dimension, found an array of shape {instants.shape}")
    for expected, wrong in (("finite numbers", ~np.isfinite(instants)), ("times from 0 on", instants < 0.0)):
        if wrong.any():
            index = int(np.argmax(wrong))
            raise CrashkitError(f"times: expected {expected}, found {instants[index]} at index {index}")
    backward = np.diff(instants) <= 0.0
    if backward.any():
        index = int(np.argmax(backward)) + 1
        found = f"{instants[index]} after {instants[index - 1]} at index {index}"
        raise CrashkitError(f"times: expected strictly increasing numbers, found {found}")
    return instants
