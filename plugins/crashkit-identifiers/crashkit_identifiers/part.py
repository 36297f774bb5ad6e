"""A part of the residuals: those of a slice of time, or all but outliers."""

import numpy as np

from crashkit.misfit import Misfit, SameVariables
from crashkit.protocols import Problem
from crashkit_identifiers.recorded import row_times


class Part(SameVariables):
    """Some of the residuals of a problem.

    Arguments:
        problem: whose bounds and start hold.
        kept: which of the readings' residuals; those that follow, of a prior, are kept; () keeps all.
        source: what gives the residuals, if not the problem itself.
    """

    def __init__(self, problem: Problem, kept: np.ndarray, source: Problem | None = None) -> None:
        super().__init__(problem)
        self.kept, self.source = kept, source or problem
        self._is_whole = bool(kept.all())

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """The residuals that are kept."""
        return self._part(self.source.residual(scaled))

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """They and their derivatives."""
        residual, jacobian = self.source.residual_and_jacobian(scaled)
        return self._part(residual), self._part(jacobian)

    def _part(self, rows: np.ndarray) -> np.ndarray:
        if self._is_whole:
            return rows
        readings = len(self.kept)
        return np.concatenate([rows[:readings][self.kept], rows[readings:]])


def up_to(share: float, misfit: Misfit, source: Misfit | None = None) -> Part:
    """The misfit up to a share of the time recorded, its residuals from `source`, if that is given."""
    if share >= 1.0:
        return Part(misfit, np.ones(0, dtype=bool), source)
    times = row_times(source or misfit)
    return Part(misfit, times <= share * times.max(initial=0.0) + 1e-12, source)
