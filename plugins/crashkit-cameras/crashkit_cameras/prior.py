"""What is known of a camera before it is calibrated: pixels are square, lenses bend little, their centre is the image's."""

import math

import numpy as np
from attrs import evolve, frozen
from scipy.special import gammaln

from crashkit_cameras.projection import PARAMETERS, Cameras


@frozen
class Prior:
    """Scales of Student's distributions about an ideal camera.

    They hold small values to zero and give way to large ones: a number that the readings do not determine stays near its
    ideal value, one that they determine to be far off costs only the logarithm of its distance.
    Infinity: nothing is known; 0: the number is ideal.

    Attributes:
        pixel_shape: of the logarithm of the aspect and of the skew.
        centre: of the principal point about the middle of the image, in half diagonals of the image; without the size of
            the image its middle is a guess, and GUESSED is the least that holds.
        radial: of the shift by k1, k2 and k3 at the image's corner, as shares of its distance from the principal point.
        decentring: of the shift by p1 and p2, likewise.
    """

    pixel_shape: float = 1e-4
    centre: float = 0.03
    radial: tuple[float, float, float] = (0.03, 0.01, 0.003)
    decentring: float = 2e-4


DISTORTION = slice(11, PARAMETERS)
GUESSED = 0.1
NORMAL_CORNER = 0.55
"""Distance of the image's corner from its middle over the focal length, of a normal lens; wider ones distort as it does
within that distance, hence more in their corners."""
PIXEL_TAIL, CENTRE_TAIL, LENS_TAIL = 1.0, 4.0, 4.0
"""Degrees of freedom: pixels are square or not at all, centres and lenses are good or less good."""
UNKNOWN = Prior(math.inf, math.inf, (math.inf,) * 3, math.inf)
"""Nothing is known: the sixteen coefficients by maximum likelihood, as the paper has them."""


@frozen(eq=False)
class Frame:
    """Where the images have their middles (view, 2) and how long their half diagonals are (view,), pixel."""

    middle: np.ndarray
    half_diagonal: np.ndarray
    guessed: bool

    def select(self, view: int) -> "Frame":
        """One view."""
        return Frame(self.middle[view : view + 1], self.half_diagonal[view : view + 1], self.guessed)


@frozen(eq=False)
class Expectation:
    """A prior in the units of certain cameras: means, scales and degrees of freedom of their numbers, (view, 16)."""

    mean: np.ndarray
    scale: np.ndarray
    tail: np.ndarray

    def cost(self, cameras: Cameras) -> float:
        """The negative logarithm of the density, but for a constant."""
        tail = self.tail[self._known()]
        return float((0.5 * (tail + 1.0) * np.log1p(self._deviation(cameras) ** 2 / tail)).sum())

    def weight(self, cameras: Cameras) -> np.ndarray:
        """Weights w (view, 16) with which w (number - mean)² / 2 has the slope of the cost, and lies above it."""
        weight = np.zeros_like(self.scale)
        known = self._known()
        tail = self.tail[known]
        weight[known] = (tail + 1.0) / self.scale[known] ** 2 / (tail + self._deviation(cameras) ** 2)
        return weight

    def difference(self, cameras: Cameras) -> np.ndarray:
        """number - mean, (view, 16)."""
        return cameras.numbers() - self.mean

    def log_density_undistorted(self) -> float:
        """The logarithm of the density of no distortion at all."""
        tail, scale = self.tail[:, DISTORTION], self.scale[:, DISTORTION]
        return float((gammaln(0.5 * tail + 0.5) - gammaln(0.5 * tail) - 0.5 * np.log(np.pi * tail) - np.log(scale)).sum())

    def without_distortion(self) -> "Expectation":
        """The same of cameras whose lenses do not distort."""
        scale = self.scale.copy()
        scale[:, DISTORTION] = 0.0
        return evolve(self, scale=scale)

    def held(self) -> np.ndarray:
        """Which numbers are not to be changed at all, (view, 16)."""
        return self.scale == 0.0

    def _known(self) -> np.ndarray:
        return np.isfinite(self.scale) & ~self.held()

    def _deviation(self, cameras: Cameras) -> np.ndarray:
        known = self._known()
        return self.difference(cameras)[known] / self.scale[known]


def expectation(prior: Prior, frame: Frame, focal: np.ndarray) -> Expectation:
    """The prior in the units of some cameras.

    Arguments:
        prior: of every camera.
        frame: of their images.
        focal: (view,), pixel, roughly.
    """
    corner = np.minimum(frame.half_diagonal / focal, NORMAL_CORNER)
    mean, scale = np.zeros((len(focal), PARAMETERS)), np.full((len(focal), PARAMETERS), np.inf)
    tail = np.full_like(mean, LENS_TAIL)
    mean[:, 9:11] = frame.middle
    scale[:, 7:9], tail[:, 7:9] = prior.pixel_shape, PIXEL_TAIL
    centre = max(prior.centre, GUESSED) if frame.guessed else prior.centre
    scale[:, 9:11], tail[:, 9:11] = centre * frame.half_diagonal[:, None], CENTRE_TAIL
    for power, share in enumerate(prior.radial):
        scale[:, 11 + power] = share / corner ** (2 * power + 2)
    scale[:, 14:] = prior.decentring / corner[:, None]
    return Expectation(mean, scale, tail)


def frame_of(image: np.ndarray, size: np.ndarray | None) -> Frame:
    """The images' middles and half diagonals.

    Where their size is not known, it is guessed: the readings leave equal margins, and pixels count from a corner unless
    some are negative.

    Arguments:
        image: (view, point, 2), pixel, all readings, NaN where hidden.
        size: (view, 2), pixel, if known.
    """
    if size is not None:
        return Frame(0.5 * size, 0.5 * np.linalg.norm(size, axis=1), guessed=False)
    least, most = np.nanmin(image, axis=(0, 1)), np.nanmax(image, axis=(0, 1))
    middle, extent = 0.5 * (least + most), 0.5 * (most - least)
    half = min(float(np.linalg.norm(np.where(least < 0.0, extent, middle))), 2.0 * float(np.linalg.norm(extent)))
    views = len(image)
    return Frame(np.tile(middle, (views, 1)), np.full(views, half), guessed=True)
