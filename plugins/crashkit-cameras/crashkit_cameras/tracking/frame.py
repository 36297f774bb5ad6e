"""A film is any iterable of frames."""

from typing import NamedTuple

import numpy as np


class Frame(NamedTuple):
    """An image and when it was taken.

    Attributes:
        time: s, the middle of the exposure.
        image: brightness, (row v from the top, column u from the left); the middle of the first pixel is at u = v = 0.
    """

    time: float
    image: np.ndarray
