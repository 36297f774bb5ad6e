"""What a target's image is made of: a pattern of dark (-1) and bright (1), blurred, wherever it is and however it is seen."""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np


class Pattern(ABC):
    """A target as a function of image coordinates and of a vector `shape`, whose first two values are its centre.

    Attributes:
        name: as users choose it.
        fitted: how many values of a shape are fitted; the others say how far the pattern reaches.
        toned: whether the tone between dark and bright is fitted too (the edge of a dot cannot tell it from its size).
    """

    name: ClassVar[str]
    fitted: ClassVar[int]
    toned: ClassVar[bool]

    @abstractmethod
    def shape(self, centre: np.ndarray, radius: float, angle: float) -> np.ndarray:
        """The shape of a target seen square on.

        Arguments:
            centre: u, v, pixel.
            radius: of its disc, pixel.
            angle: by which it is turned from u towards v, rad; without meaning for a dot.
        """

    @abstractmethod
    def values(self, shape: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The pattern's means over pixels, and their derivatives to the fitted shape, (fitted, pixel)."""

    @abstractmethod
    def inside(self, shape: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Which points of the image the pattern describes: those that the target's surroundings don't reach."""

    @abstractmethod
    def reach(self, shape: np.ndarray) -> np.ndarray:
        """Half the width and height of a box around the points that the pattern describes, pixel."""

    @abstractmethod
    def radius(self, shape: np.ndarray) -> float:
        """The radius of the disc with the target's area in the image, pixel."""

    @abstractmethod
    def bounded(self, shape: np.ndarray) -> np.ndarray:
        """The nearest shape that makes sense."""

    @abstractmethod
    def measured(self, shape: np.ndarray, image: np.ndarray) -> np.ndarray:
        """The shape with the values that are not fitted taken from the image."""

    @abstractmethod
    def template(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """What a search looks for, at places in radii from the centre: complex, its argument the angle; 0 far away."""
