"""A quantity of the motion at the time stamps of an instrument, along the axes of its sensors."""

import numpy as np
from attrs import frozen
from numba import njit


@frozen(eq=False)
class Felt:
    """What sensors without errors would feel, at the times of the motion.

    Attributes:
        times: s, (node,).
        values: (node, row, axis).
        sensitivity: its derivatives to the model's parameters, (node, row, axis, parameter), if the motion has them.
        by_point: its derivatives to the sensors' points, (node, row, axis, 3), where the bodies turn.
        rows: of each sensor.
        axes: names of the axes.
    """

    times: np.ndarray
    values: np.ndarray
    sensitivity: np.ndarray | None
    by_point: np.ndarray | None
    rows: np.ndarray
    axes: tuple[str, ...]

    def known(self, at: np.ndarray) -> slice:
        """The time stamps that the motion tells of; before contact, at t = 0, it is uniform."""
        first = 0 if self.times[0] <= 0.0 else int(np.searchsorted(at, self.times[0], side="left"))
        return slice(first, max(first, int(np.searchsorted(at, self.times[-1], side="right"))))

    def sampled(self, values: np.ndarray, mixing: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Each channel, a sum over the axes of what its sensor feels.

        Linear between nodes, because accelerations and forces have corners; 0 before the first node.

        Arguments:
            values: (node, row, axis) or (node, row, axis, column).
            mixing: (sensor, axis of the channel, axis).
            at: s, increasing, none after the last node.

        Returns:
            (time, channel, column), the channels by sensor and axis.
        """
        columns = values if values.ndim == 4 else values[..., None]
        result = _interpolate(self.times, columns, self.rows, mixing, at)
        return result.reshape(len(at), mixing.shape[0] * mixing.shape[1], columns.shape[3])


@njit(cache=True, error_model="numpy")
def _interpolate(
    nodes: np.ndarray, values: np.ndarray, rows: np.ndarray, mixing: np.ndarray, at: np.ndarray
) -> np.ndarray:  # pragma: no cover
    """Plain loops: whole-array expressions would go through memory five times."""
    result = np.zeros((len(at), *mixing.shape[:2], values.shape[3]))
    right = 1
    for time in range(len(at)):
        if at[time] < nodes[0]:
            continue
        while right < len(nodes) - 1 and nodes[right] <= at[time]:
            right += 1
        weight = (at[time] - nodes[right - 1]) / (nodes[right] - nodes[right - 1])
        for sensor in range(len(rows)):
            for axis in range(mixing.shape[2]):
                start, end = values[right - 1, rows[sensor], axis], values[right, rows[sensor], axis]
                for channel in range(mixing.shape[1]):
                    share = mixing[sensor, channel, axis]
                    if share == 0.0:
                        continue
                    for column in range(values.shape[3]):
                        value = start[column] + weight * (end[column] - start[column])
                        result[time, sensor, channel, column] += share * value
    return result
