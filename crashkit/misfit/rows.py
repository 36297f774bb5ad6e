"""The samples of a group that were recorded, as rows of a residual vector."""

import numpy as np
from attrs import frozen

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
        np.multiply(columns[self.kept], scaling, out=table)
        table *= -self.weights[:, None]


def rows_of(group: Group) -> Rows:
    """The rows of a group."""
    recorded = group.recorded.reshape(-1)
    weights = np.array([channel.noise.weight for channel in group.channels])
    present = np.flatnonzero(np.isfinite(recorded))
    kept = slice(None) if len(present) == len(recorded) else present
    return Rows(kept, recorded[kept], np.tile(weights, len(group.recorded))[kept])
