"""A target's place by least squares: pattern, light and contrast fitted to the image around it."""

import numpy as np
from attrs import frozen

from crashkit_cameras.tracking.pattern import Pattern
from crashkit_cameras.tracking.problem import CENTRE, GRADIENTS, LIGHT, State, chosen, least_pixels, problem_around, robust

NEARING = ((1.0, slice(LIGHT + len(CENTRE))), (0.5, slice(None)))
"""Scales, in contrasts, by which pixels count less on the way to the target, and the values that are free: first the place."""
NEARED, STILL = 1e-2, 1e-3
"""pixel; a shorter step is the last."""
ROUNDS = 5
MOVED, FEW = 0.1, 0.02
"""pixel, and part of the pixels; after a longer way, or where more of them differ, they are chosen anew."""
LEAST_SEEN = 0.5
"""The part of a target that must not be hidden."""
HOPELESS = 0.2
"""Quality below which nobody would speak of a target."""
MODEL_ERROR = 0.001
"""pixel; what edges that are not blurred by a normal distribution add to the noise."""


@frozen
class Fit:
    """A target found in an image.

    Attributes:
        pattern: that was fitted.
        shape: of the pattern; the first two values are its centre, pixel.
        covariance: of the centre and the gradients, (6, 6), in their units.
        gradients: of the ground along u and v and of the contrast along u and v, in the image's units for each pixel.
        contrast: half the difference of bright and dark, in the image's units; negative where they have changed places.
        quality: the share of the image's variation in the target that the pattern explains, 0 to 1.
    """

    pattern: Pattern
    shape: np.ndarray
    covariance: np.ndarray
    gradients: np.ndarray
    contrast: float
    quality: float

    @property
    def centre(self) -> np.ndarray:
        """u, v, pixel."""
        return self.shape[:2]

    @property
    def radius(self) -> float:
        """Of the disc with the target's area, pixel."""
        return self.pattern.radius(self.shape)

    @property
    def std(self) -> np.ndarray:
        """Standard deviation of u and of v, pixel."""
        return np.asarray(np.sqrt(np.diag(self.covariance)[:2]))


def fit(pattern: Pattern, image: np.ndarray, shape: np.ndarray) -> Fit | None:
    r"""Fit a pattern to an image, from a start that is off by less than half a radius.

    The image at the pixel x, with m the pattern's mean over the pixel's square, ground b, contrast k and tone h:

        I(x) = b + b'x + (k + k'x) m(x; shape) + h (1 - m^2)

    by Gauss-Newton with Marquardt's damping. Saturated pixels may be brighter than they say. Pixels far from the fit
    (glints, something in front) count less on the way, and in the end not at all. The covariance is White's (1980,
    doi:10.2307/1912934): it also holds for noise that differs from pixel to pixel.

    Arguments:
        image: brightness, (row v, column u).
        shape: where and how the target is expected; see the pattern.

    Returns None where the target is not whole in the image, where more than half of it is hidden, and where the fit does not
    come to rest.
    """
    origin, near = shape[:2], _neared(pattern, image, shape)
    if near is None:
        return None
    for _ in range(ROUNDS):
        problem = problem_around(pattern, image, near[LIGHT:], origin)
        if problem is None:
            return None
        start = problem.state(near)
        used = problem.near(start)
        if used.sum() < least_pixels(pattern):
            return None
        state, rested = problem.converge(start, chosen(used), STILL)
        quality = problem.quality(state)
        if quality < HOPELESS:
            return None
        if rested and _moved(start, state) < MOVED and np.mean(used != problem.near(state)) < FEW:
            break
        near = state.values
    else:
        return None
    if used.mean() < LEAST_SEEN or problem.steep(state):
        return None
    error = problem.errors(state, used, CENTRE + GRADIENTS)
    covariance = error @ error.T + np.diag([MODEL_ERROR**2] * 2 + [0.0] * 4)
    return Fit(pattern, state.values[LIGHT:], covariance, state.values[GRADIENTS], state.contrast, quality)


def _neared(pattern: Pattern, image: np.ndarray, shape: np.ndarray) -> np.ndarray | None:
    """Light and shape near the target, whatever lies in front of it; None where the target is not whole in the image."""
    problem = problem_around(pattern, image, shape, shape[:2])
    if problem is None:
        return None
    state = problem.lit(shape)
    for scale, free in NEARING:
        state, _ = problem.converge(state, robust(scale * abs(state.contrast)), NEARED, free)
    return state.values


def _moved(one: State, other: State) -> float:
    return float(np.hypot(*(other.values - one.values)[CENTRE]))
