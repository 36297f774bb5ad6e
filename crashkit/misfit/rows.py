"""The samples of a group that were recorded, as rows of a residual vector."""

import numpy as np
from attrs import frozen
from numba import njit

from crashkit.misfit.channel import Group
from crashkit.misfit.predictor import Prediction


@frozen(eq=False)
class Rows:
    """One row for each sample that was recorded.

    Arguments:
        kept: which samples of (time, column), flattened; all of them are a slice, which copies nothing.
        recorded: (row,).
        weights: (row,) what a residual is multiplied by.
    """

    kept: np.ndarray | slice
    recorded: np.ndarray
    weights: np.ndarray

    def residual(self, prediction: Prediction) -> np.ndarray:
        """(recorded - predicted) weight."""
        return (self.recorded - prediction.samples.reshape(-1)[self.kept]) * self.weights

    def jacobian(self, prediction: Prediction, scaling: np.ndarray, table: np.ndarray) -> None:
        """Its derivatives to search variables, into `table` (row, parameter); with `scaling` of `SearchVariables`."""
        sensitivity = prediction.sensitivity
        assert sensitivity is not None  # asked for by the only caller
        columns = sensitivity.reshape(len(sensitivity) * sensitivity.shape[1], sensitivity.shape[2])
        _weighed(columns[self.kept], scaling, self.weights, table)


@njit(cache=True)
def _weighed(
    columns: np.ndarray, scaling: np.ndarray, weights: np.ndarray, table: np.ndarray
) -> None:  # pragma: no cover - compiled
    """-columns scaling weights, in one pass over what may be megabytes."""
    for row in range(len(weights)):
        own, weighed, weight = columns[row], table[row], -weights[row]
        for column in range(scaling.size):
            weighed[column] = own[column] * scaling[column] * weight


def rows_of(group: Group) -> Rows:
    """The rows of a group."""
    recorded = group.recorded.reshape(-1)
    weights = np.array([channel.noise.weight for channel in group.channels])
    present = np.flatnonzero(np.isfinite(recorded))
    kept = slice(None) if len(present) == len(recorded) else present
    return Rows(kept, recorded[kept], np.tile(weights, len(group.recorded))[kept])
