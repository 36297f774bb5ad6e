"""Markers on a body that rocks about an axis which the model leaves out."""

import numpy as np

from crashkit.data.ringing import ringing, ringing_derivatives
from crashkit_cameras.marker_motion import MarkerMotion


class Rocking:
    """w = ringing(u) - u, u the displacement from a uniform motion: the markers are at share w beside their bodies.

    Arguments:
        seen: the markers on bodies that do not turn.
        at: s, (time,).
        frequency, damping: of each marker and axis, Hz and of critical, (marker, axis).
    """

    def __init__(self, seen: MarkerMotion, at: np.ndarray, frequency: np.ndarray, damping: np.ndarray) -> None:
        self._known = np.isfinite(seen.position).all(axis=(1, 2))
        self._at = at[self._known]
        self._oscillator = frequency.ravel(), damping.ravel()
        self._shape = seen.position.shape
        lapse = at[:, None, None]
        self._moved = seen.position - seen.start - lapse * seen.start_velocity
        self._rate = seen.velocity - seen.start_velocity

    def displacement(self) -> np.ndarray:
        """w, (time, marker, axis)."""
        return self.linear(self._moved[..., None])[..., 0]

    def rate(self) -> np.ndarray:
        """dw/dt."""
        return self.linear(self._rate[..., None])[..., 0]

    def linear(self, columns: np.ndarray) -> np.ndarray:
        """The same map of other displacements, (time, marker, axis, column)."""
        flat = self._flat(columns)
        return self._full(ringing(flat, self._at, *self._oscillator) - flat, columns.shape[3])

    def derivatives(self) -> tuple[np.ndarray, np.ndarray]:
        """Of w, to frequency and damping."""
        changes = ringing_derivatives(self._flat(self._moved[..., None]), self._at, *self._oscillator)
        by_frequency, by_damping = (self._full(change, 1)[..., 0] for change in changes)
        return by_frequency, by_damping

    def _flat(self, columns: np.ndarray) -> np.ndarray:
        return np.ascontiguousarray(columns[self._known]).reshape(len(self._at), -1, columns.shape[3])

    def _full(self, flat: np.ndarray, columns: int) -> np.ndarray:
        """NaN where the motion tells of nothing."""
        full = np.full((*self._shape, columns), np.nan)
        full[self._known] = flat.reshape(-1, *self._shape[1:], columns)
        return full
