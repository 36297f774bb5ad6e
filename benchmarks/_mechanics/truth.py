"""What the motion and its derivatives are, by the reference in extended precision and differences of it."""

from collections.abc import Mapping

import numpy as np

from benchmarks._mechanics.models import Case
from benchmarks._mechanics.reference import Floats, Reference

FINER = 8
"""Of the step, for the truth: the rule is of fourth order, so that its own error is 4096 times less."""
NUDGE = {1: 1e-6, 2: 1e-5}
"""Of a parameter, for differences with 64 bits, by number of axes: in the plane rounding is felt more."""
UNSEEN = 1e-9
"""Of the largest change of the motion for a relative change of a parameter: what is less is none but for rounding."""
WEIGHTS: Mapping[int, float] = {1: 1.5, 2: -0.75, 3: 1.0 / 6.0}
"""Of the differences between so many nudges ahead and behind: of third order, also where the second derivative jumps."""


class Truth:
    """Positions (time, coordinate) and their derivatives (time, coordinate, parameter) at some times of a case."""

    def __init__(self, case: Case, times: Floats) -> None:
        self.reference = Reference(case.model, extended=True)
        self.times, self.step = times, case.step / FINER
        self.position = self._run()
        self.derivatives = np.stack([self._derivative(path) for path in case.paths], axis=-1)

    def _run(self) -> Floats:
        return self.reference.run(self.times, self.step)[0].position

    def _derivative(self, path: str) -> Floats:
        kept = self.reference.input.copy()
        value = self.reference.value(path)
        step = NUDGE[len(self.reference.model.axes)] * abs(value)
        total = 0.0
        for nudges, weight in WEIGHTS.items():
            for sign in (1.0, -1.0):
                self.reference.put(path, value + sign * nudges * step)
                total = total + sign * weight * self._run()
                self.reference.input[...] = kept
        return total / step


def worst(found: Floats, expected: Floats, values: Floats) -> float:
    """The largest error of a parameter's column, relative to the largest in it, of parameters that the motion sees."""
    errors, sizes = (np.abs(columns).max(axis=(0, 1)) for columns in (found - expected, expected))
    weights = sizes * np.abs(values)
    seen = weights > UNSEEN * weights.max()
    return float((errors[seen] / sizes[seen]).max())


def differences(reference: Reference, case: Case, times: Floats) -> Floats:
    """Derivatives as people take them: central differences of plain runs at the same step."""
    columns = []
    for path in case.paths:
        value, ends = reference.value(path), []
        for sign in (1.0, -1.0):
            reference.put(path, value * (1.0 + sign * 1e-6))
            ends.append(reference.run(times, case.step, plain=True)[0].position)
        reference.put(path, value)
        columns.append((ends[0] - ends[1]) / (2e-6 * value))
    return np.stack(columns, axis=-1)
