"""The least-squares problem of a target in an image: light and pattern, and the pixels around them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from attrs import frozen
from scipy.ndimage import binary_dilation
from scipy.stats import median_abs_deviation

from crashkit_cameras.tracking.pattern import Pattern

LIGHT = 7
"""Values that say how bright the pattern is: ground and its gradient, contrast and its gradient, tone."""
CONTRAST = 3
TONE = 6
GRADIENTS = [1, 2, 4, 5]
STEEPEST = 0.5
"""The largest change of light over a radius, in contrasts."""
CENTRE = [LIGHT, LIGHT + 1]
LEAST_PIXELS_PER_VALUE = 2
OUTLIER_DEVIATIONS, OUTLIER_CONTRAST = 4.0, 0.25
"""How far a pixel may be from the fit, in deviations of the noise and in contrasts; the larger counts."""
OUTLIER_REACH = 2
"""pixel; what blur makes of the rim of something in front."""
ITERATIONS, DAMPING, SETTLED = 20, 1e-3, 1e-2
"""The last step lowers the cost by less than a part of it."""
DEPTHS = (8, 10, 12, 14, 16)
"""Bits of sensors."""
TINY = 1e-12

Weigh = Callable[[np.ndarray], tuple[np.ndarray, float]]
"""From residuals to the roots of their weights, and the cost that is to fall."""


class State(NamedTuple):
    """Light and shape, the residual of the image, and the derivatives of the model to the values, (value, pixel)."""

    values: np.ndarray
    residual: np.ndarray
    slopes: np.ndarray

    @property
    def contrast(self) -> float:
        """Half the difference of bright and dark."""
        return float(self.values[CONTRAST])


@frozen(eq=False)
class Problem:
    """Light and pattern on the pixels around a target.

    Attributes:
        pattern: of the target.
        u, v, grey: the pixels' places and brightness.
        darkest, brightest: what can be recorded.
        plane: 1, and the way from the origin along u and v, of each pixel: what the light's gradients multiply.
    """

    pattern: Pattern
    u: np.ndarray
    v: np.ndarray
    grey: np.ndarray
    darkest: float
    brightest: float
    plane: np.ndarray

    def state(self, values: np.ndarray) -> State:
        """The model evaluated; where a saturated pixel should be brighter still, there is no residual."""
        m, to_shape = self.pattern.values(values[LIGHT:], self.u, self.v)
        slopes = np.zeros((len(values), m.size))
        slopes[:LIGHT] = self._to_light(m)
        contrast = values[CONTRAST:TONE] @ self.plane - 2.0 * values[TONE] * m
        slopes[LIGHT : LIGHT + self.pattern.fitted] = contrast * to_shape
        residual = self.grey - values[:LIGHT] @ slopes[:LIGHT]
        beyond = ((self.grey >= self.brightest) & (residual < 0.0)) | ((self.grey <= self.darkest) & (residual > 0.0))
        slopes[:, beyond] = 0.0
        residual[beyond] = 0.0
        return State(values, residual, slopes)

    def lit(self, shape: np.ndarray) -> State:
        """A shape in the light that fits it best."""
        m, _ = self.pattern.values(shape, self.u, self.v)
        return self.state(self._bounded(np.append(_step(self.grey, self._to_light(m), 0.0), shape)))

    def converge(self, state: State, weigh: Weigh, still: float, free: slice = slice(None)) -> tuple[State, bool]:
        """Gauss-Newton with Marquardt's damping, on some of the values; and whether the centre came to rest.

        Arguments:
            still: pixel; a shorter step is the last, if it settles the shape too.
        """
        damping, held = DAMPING, np.ones((len(state.values), 1), dtype=bool)
        held[free] = False
        root, cost = weigh(state.residual)
        for _ in range(ITERATIONS):
            values = state.values + _step(root * state.residual, root * np.where(held, 0.0, state.slopes), damping)
            values = self._bounded(values)
            moved = np.hypot(*(values - state.values)[CENTRE])
            trial = self.state(values)
            trial_root, trial_cost = weigh(trial.residual)
            settled = cost - trial_cost < SETTLED * cost
            if trial_cost <= cost:
                state, root, cost, damping = trial, trial_root, trial_cost, 0.1 * damping
            else:
                damping *= 10.0
            if moved < still and settled:
                return state, True
        return state, False

    def near(self, state: State) -> np.ndarray:
        """Which pixels, with their neighbours, are as near to the fit as noise is, or within a part of the contrast."""
        distance = np.abs(state.residual)
        noise = median_abs_deviation(state.residual, scale="normal")
        far = distance > max(OUTLIER_DEVIATIONS * noise, OUTLIER_CONTRAST * abs(state.contrast))
        if not far.any():
            return ~far
        u, v = self.u - self.u.min(), self.v - self.v.min()
        outliers = np.zeros((v.max() + 1, u.max() + 1), dtype=bool)
        outliers[v, u] = far
        return ~binary_dilation(outliers, iterations=OUTLIER_REACH)[v, u]

    def errors(self, state: State, used: np.ndarray, values: list[int]) -> np.ndarray:
        """How far each pixel's residual moves some of the values, (value, pixel); its square is White's covariance."""
        slopes, size = _scaled(state.slopes[:, used])
        gain = np.linalg.solve(slopes @ slopes.T + TINY * np.eye(len(size)), slopes)
        leverage = np.sum(gain * slopes, axis=0).clip(max=0.99)
        return (gain / size)[values] * state.residual[used] / np.sqrt(1.0 - leverage)

    def quality(self, state: State) -> float:
        """The share of the variation, beyond a gradient of the light, that the model explains; 0 at least."""
        unpatterned = self.grey - self.plane.T @ _step(self.grey, self.plane, 0.0)
        return max(float(1.0 - np.sum(state.residual**2) / max(np.sum(unpatterned**2), np.finfo(float).tiny)), 0.0)

    def steep(self, state: State) -> bool:
        """Whether the light changes as much as it may: that is no light, but something in front of the target."""
        return bool(np.max(np.abs(state.values[GRADIENTS])) > 0.99 * self._steepest(state.values))

    def _bounded(self, values: np.ndarray) -> np.ndarray:
        """The nearest values that make sense."""
        bounded = np.append(values[:LIGHT], self.pattern.bounded(values[LIGHT:]))
        steepest = self._steepest(bounded)
        bounded[GRADIENTS] = bounded[GRADIENTS].clip(-steepest, steepest)
        return bounded

    def _steepest(self, values: np.ndarray) -> float:
        """The largest gradient of the light, in the image's units for each pixel."""
        return STEEPEST * abs(float(values[CONTRAST])) / self.pattern.radius(values[LIGHT:])

    def _to_light(self, m: np.ndarray) -> np.ndarray:
        """The derivatives of a pattern's brightness to the light."""
        return np.concatenate([self.plane, m * self.plane, (self.pattern.toned * (1.0 - m * m))[None]])


def problem_around(pattern: Pattern, image: np.ndarray, shape: np.ndarray, origin: np.ndarray) -> Problem | None:
    """The problem on the pixels that a pattern describes; None where some are outside the image, or there are too few."""
    reach = pattern.reach(shape)
    low, high = np.floor(shape[:2] - reach).astype(int), np.ceil(shape[:2] + reach).astype(int)
    if np.any(high < 0) or np.any(low >= image.shape[::-1]):
        return None
    u, v = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    inside = pattern.inside(shape, u, v)
    u, v = u[inside], v[inside]
    if u.size < least_pixels(pattern) or min(u.min(), v.min()) < 0 or u.max() >= image.shape[1] or v.max() >= image.shape[0]:
        return None
    plane = np.stack([np.ones(u.size), u - origin[0], v - origin[1]])
    return Problem(pattern, u, v, image[v, u].astype(float), *_range(image), plane)


def least_pixels(pattern: Pattern) -> int:
    """The fewest pixels that can be fitted."""
    return LEAST_PIXELS_PER_VALUE * (LIGHT + pattern.fitted)


def robust(scale: float) -> Weigh:
    """Geman and McClure's weighing, by which pixels much further away than the scale hardly count."""

    def weigh(residual: np.ndarray) -> tuple[np.ndarray, float]:
        square = (residual / scale) ** 2
        return 1.0 / (1.0 + square), float(np.sum(square / (1.0 + square)))

    return weigh


def chosen(used: np.ndarray) -> Weigh:
    """Some pixels count alike, the others not at all."""
    return lambda residual: (used, float(np.sum(residual[used] ** 2)))


def _range(image: np.ndarray) -> tuple[float, float]:
    """The least and the largest brightness that an image's type, and the depth of its sensor, can hold."""
    if not np.issubdtype(image.dtype, np.integer):
        return -np.inf, np.inf
    largest = 0 if image.dtype.itemsize == 1 else image.max()
    return 0.0, next((2.0**bits - 1.0 for bits in DEPTHS if largest < 2**bits), np.inf)


def _step(residual: np.ndarray, slopes: np.ndarray, damping: float) -> np.ndarray:
    """A damped step; 0 for values on which nothing depends."""
    scaled, size = _scaled(slopes)
    normal = scaled @ scaled.T + (damping + TINY) * np.eye(len(size))
    return np.asarray(np.linalg.solve(normal, scaled @ residual) / size[:, 0])


def _scaled(slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives with lengths of 1, and what they were divided by, (value, 1)."""
    size = np.sqrt(np.sum(slopes * slopes, axis=1, keepdims=True))
    size[size == 0.0] = 1.0
    return slopes / size, size
