"""Where a target has been, and where it is to be expected."""

import numpy as np
from attrs import Factory, define

REMEMBERED = 5
STEADY_GAP = 2.5
"""Intervals between frames; after a longer gap the path is continued straight on."""


@define
class Path:
    """The places of a target so far: times, s, and u, v, pixel."""

    times: list[float] = Factory(list)
    places: list[np.ndarray] = Factory(list)

    def add(self, time: float, place: np.ndarray) -> None:
        """The target was seen."""
        self.times.append(time)
        self.places.append(place)

    def expected(self, time: float) -> np.ndarray:
        """Where the target should be: a parabola through its last places, a line after a gap or where there are few."""
        times, places = np.array(self.times[-REMEMBERED:]), np.array(self.places[-REMEMBERED:])
        if len(times) == 1:
            return places[0]
        interval = abs(times[-1] - times[0]) / (len(times) - 1)
        after_gap = abs(time - times[-1]) > STEADY_GAP * interval
        degree = 2 if len(times) > 3 and not after_gap else 1
        return np.polynomial.polynomial.polyfit((times - time) / interval, places, degree)[0]
