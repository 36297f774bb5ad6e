"""A target's place by least squares: pattern, light and contrast fitted to the image around it."""

from typing import NamedTuple

import numpy as np
from attrs import frozen
from scipy.ndimage import binary_dilation

from crashkit_cameras.tracking.pattern import Pattern

LIGHT = 7
"""Values that say how bright the pattern is: ground and its gradient, contrast and its gradient, tone."""
CONTRAST = 3
TONE = 6
CENTRE = slice(LIGHT, LIGHT + 2)
TOLERANCES = (np.inf, 1.0, 0.5, 0.25)
"""Parts of the contrast by which a pixel may differ from the fit, round by round."""
OUTLIER_DEVIATIONS = 4.0
LEAST_PIXELS_PER_VALUE = 2
ITERATIONS = 15
DAMPING = 1e-3
STILL, MOVED = 1e-3, 0.1
"""pixel; a shorter step is the last, and after a longer way the pixels are chosen anew."""
HOPELESS = 0.2
"""Quality below which nobody would speak of a target."""
DEPTHS = (8, 10, 12, 14, 16)
"""Bits of sensors."""
TINY = 1e-12
MODEL_ERROR = 0.002
"""pixel; what edges that are not blurred by a normal distribution add to the noise."""


@frozen
class Fit:
    """A target found in an image.

    Attributes:
        pattern: that was fitted.
        shape: of the pattern; the first two values are its centre, pixel.
        covariance: of the centre, pixel^2, (2, 2).
        contrast: half the difference of bright and dark, in the image's units; negative where they have changed places.
        quality: the share of the image's variation in the target that the pattern explains, 0 to 1.
    """

    pattern: Pattern
    shape: np.ndarray
    covariance: np.ndarray
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
        return np.sqrt(np.diag(self.covariance))


class Patch(NamedTuple):
    """The pixels around a target: their places, their brightness, and the darkest and brightest that can be recorded."""

    u: np.ndarray
    v: np.ndarray
    grey: np.ndarray
    range: tuple[float, float]


def fit(pattern: Pattern, image: np.ndarray, shape: np.ndarray) -> Fit | None:
    r"""Fit a pattern to an image, from a start that is off by less than half a radius.

    The image at the pixel x, with m the pattern's mean over the pixel's square, ground b, contrast k and tone h:

        I(x) = b + b'x + (k + k'x) m(x; shape) + h (1 - m^2)

    by Gauss-Newton with Marquardt's damping. Saturated pixels may be brighter than they say. Pixels far from the fit
    (glints, something in front) are left out, in rounds that become stricter. The covariance is White's (1980,
    doi:10.2307/1912934): it also holds for noise that differs from pixel to pixel.

    Arguments:
        image: brightness, (row v, column u).
        shape: where and how the target is expected; see the pattern.

    Returns None where the target is not whole in the image, or where the fit does not come to rest.
    """
    origin, values = shape[:2], np.zeros(0)
    for tolerance in TOLERANCES:
        patch = cut(pattern, image, shape)
        if patch is None:
            return None
        problem = _Problem(pattern, patch, origin)
        start = problem.state(values) if values.size else problem.lit(shape)
        import os
        mode=os.environ.get("ROB","0")
        if tolerance==np.inf and mode!="0":
            act=np.zeros(LIGHT+len(shape),bool); act[:TONE]=True; act[LIGHT:LIGHT+2]=True
            if mode=="2": act[[1,2,4,5]]=False
            rested = problem.converge(start, np.ones(patch.u.size,bool), act, float(os.environ.get("TAU","1")))
            if rested is None: return None
            if mode=="3":
                act[LIGHT:]=True
                rested = problem.converge(rested, np.ones(patch.u.size,bool), act, .5)
        else:
            rested = problem.converge(start, problem.near(start, tolerance))
        if rested is None or problem.quality(rested) < HOPELESS:
            return None
        state, values, shape = rested, rested.values, rested.values[LIGHT:]
        used = problem.near(state, TOLERANCES[-1])
        if used.sum() < _least(pattern):
            return None
        if tolerance!=np.inf and used.all() and np.hypot(*(values - start.values)[CENTRE]) < MOVED:
            break
    return problem.result(state, used)


def cut(pattern: Pattern, image: np.ndarray, shape: np.ndarray) -> Patch | None:
    """The pixels that a pattern describes; None where some are outside the image, or where there are too few."""
    reach = pattern.reach(shape)
    low, high = np.floor(shape[:2] - reach).astype(int), np.ceil(shape[:2] + reach).astype(int)
    if np.any(high < 0) or np.any(low >= image.shape[::-1]):
        return None
    u, v = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    inside = pattern.inside(shape, u, v)
    u, v = u[inside], v[inside]
    if u.size < _least(pattern):
        return None
    if min(u.min(), v.min()) < 0 or u.max() >= image.shape[1] or v.max() >= image.shape[0]:
        return None
    return Patch(u, v, image[v, u].astype(float), _range(image))


def _least(pattern: Pattern) -> int:
    """The fewest pixels that can be fitted."""
    return LEAST_PIXELS_PER_VALUE * (LIGHT + pattern.fitted)


def _range(image: np.ndarray) -> tuple[float, float]:
    """The least and largest brightness that an image's type, and the depth of its sensor, can hold."""
    if not np.issubdtype(image.dtype, np.integer):
        return -np.inf, np.inf
    brightest = 0 if image.dtype.itemsize == 1 else image.max()
    return 0.0, next((2.0**bits - 1.0 for bits in DEPTHS if brightest < 2**bits), np.inf)


class _State(NamedTuple):
    """Light and shape, the residual of the image, and the derivatives of the model to the values, (value, pixel)."""

    values: np.ndarray
    residual: np.ndarray
    slopes: np.ndarray


class _Problem:
    """Light and pattern on the pixels of a patch."""

    def __init__(self, pattern: Pattern, patch: Patch, origin: np.ndarray) -> None:
        self.pattern, self.patch = pattern, patch
        self.plane = np.stack([np.ones(patch.u.size), patch.u - origin[0], patch.v - origin[1]])

    def state(self, values: np.ndarray) -> _State:
        """The model evaluated."""
        m, to_shape = self.pattern.values(values[LIGHT:], self.patch.u, self.patch.v)
        slopes = np.zeros((len(values), m.size))
        slopes[:LIGHT] = self.to_light(m)
        contrast = values[CONTRAST:TONE] @ self.plane - 2.0 * values[TONE] * m
        slopes[LIGHT : LIGHT + self.pattern.fitted] = contrast * to_shape
        grey, (darkest, brightest) = values[:LIGHT] @ slopes[:LIGHT], self.patch.range
        residual = self.patch.grey - grey
        beyond = ((self.patch.grey >= brightest) & (residual < 0.0)) | ((self.patch.grey <= darkest) & (residual > 0.0))
        slopes[:, beyond] = 0.0
        residual[beyond] = 0.0
        return _State(values, residual, slopes)

    def to_light(self, m: np.ndarray) -> np.ndarray:
        """The derivatives of the brightness of a pattern to the light."""
        return np.concatenate([self.plane, m * self.plane, (self.pattern.toned * (1.0 - m * m))[None]])

    def lit(self, shape: np.ndarray) -> _State:
        """A shape in the light that fits it best."""
        m, _ = self.pattern.values(shape, self.patch.u, self.patch.v)
        return self.state(np.append(_step(self.patch.grey, self.to_light(m), 0.0), shape))

    def near(self, state: _State, tolerance: float) -> np.ndarray:
        """Which pixels lie, as their neighbours do, as near to the fit as noise, or as a part of the contrast."""
        if tolerance == np.inf:
            return np.ones(self.patch.grey.size, dtype=bool)
        distance = np.abs(state.residual)
        noise = 1.4826 * np.median(distance)
        far = distance > max(OUTLIER_DEVIATIONS * noise, tolerance * abs(state.values[CONTRAST]))
        if not far.any():
            return ~far
        u, v = self.patch.u - self.patch.u.min(), self.patch.v - self.patch.v.min()
        outliers = np.zeros((v.max() + 1, u.max() + 1), dtype=bool)
        outliers[v, u] = far
        return ~binary_dilation(outliers)[v, u]

    def converge(self, state: _State, used: np.ndarray, act=None, tau=None) -> _State | None:
        """Least squares on some of the pixels; None where it does not come to rest."""
        damping = DAMPING
        if tau is not None:
            def cost(st):
                t=tau*abs(st0.values[CONTRAST]); x=(st.residual/t)**2; return np.sum(x/(1+x))
            st0=state
            for _ in range(ITERATIONS):
                t=tau*abs(st0.values[CONTRAST]); w=1/(1+(state.residual/t)**2)
                values = state.values + _step(state.residual*w, state.slopes*w*act[:,None], damping)
                values[LIGHT:] = self.pattern.bounded(values[LIGHT:])
                moved = np.hypot(*(values - state.values)[CENTRE]); trial=self.state(values)
                if cost(trial)<=cost(state): state,damping=trial,.1*damping
                else: damping*=10
                if moved<.01: return state
            return state
        for _ in range(ITERATIONS):
            values = state.values + _step(state.residual[used], state.slopes[:, used], damping)
            values[LIGHT:] = self.pattern.bounded(values[LIGHT:])
            moved = np.hypot(*(values - state.values)[CENTRE])
            trial = self.state(values)
            if np.sum(trial.residual[used] ** 2) <= np.sum(state.residual[used] ** 2):
                state, damping = trial, 0.1 * damping
            else:
                damping *= 10.0
            if moved < STILL:
                return state
        return None

    def result(self, state: _State, used: np.ndarray) -> Fit:
        """The fit, with the covariance of its centre."""
        slopes, size = _scaled(state.slopes[:, used])
        gain = np.linalg.solve(slopes @ slopes.T + TINY * np.eye(len(size)), slopes)
        leverage = np.sum(gain * slopes, axis=0)
        error = (gain / size)[CENTRE] * state.residual[used] / np.sqrt(1.0 - leverage.clip(max=0.99))
        covariance = error @ error.T + MODEL_ERROR**2 * np.eye(2)
        contrast = float(state.values[CONTRAST])
        return Fit(self.pattern, state.values[LIGHT:], covariance, contrast, max(self.quality(state), 0.0))

    def quality(self, state: _State) -> float:
        """The share of the variation, beyond a gradient of the light, that the model explains."""
        unpatterned = self.patch.grey - self.plane.T @ _step(self.patch.grey, self.plane, 0.0)
        return float(1.0 - np.sum(state.residual**2) / max(np.sum(unpatterned**2), np.finfo(float).tiny))


def _step(residual: np.ndarray, slopes: np.ndarray, damping: float) -> np.ndarray:
    """A damped Gauss-Newton step; 0 for values on which nothing depends."""
    scaled, size = _scaled(slopes)
    normal = scaled @ scaled.T + (damping + TINY) * np.eye(len(size))
    return np.linalg.solve(normal, scaled @ residual) / size[:, 0]


def _scaled(slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives with lengths of 1, and what they were divided by, (value, 1)."""
    size = np.sqrt(np.sum(slopes * slopes, axis=1, keepdims=True))
    size[size == 0.0] = 1.0
    return slopes / size, size
