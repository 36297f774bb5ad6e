"""The dot target: a disc on a ground of another brightness, seen as an ellipse."""

import numpy as np

from crashkit_cameras.tracking.edge import edge
from crashkit_cameras.tracking.pattern import Pattern

SHARPEST, TYPICAL_BLUR = 0.1, 0.7
"""pixel"""
SEEN_BLUR, SEEN_GROUND = 2.0, 0.2
"""How much of the ground is looked at, in deviations of the blur and in radii; the larger counts."""
GROUND = 1.4
"""Radii; the ground that a search expects around a dot."""
FLATTEST = 1e-3
"""The least eigenvalue of M over the largest."""
FAR = 100.0
"""pixel; an edge further away does not matter."""
TINY = 1e-9


class Dot(Pattern):
    r"""An ellipse x'M x = 1 (x from its centre) with a blurred edge: bright outside.

        m = E(d),   d = (x'M x - 1) / (2 |M x|),   σ² = n'Σ n,   n = M x / |M x|,

    with E the edge's value (see `edge`), d the distance from the ellipse to first order, and Σ the covariance of the blur.

    The shape: centre u, v; M's uu, vv, uv, pixel^-2; Σ's uu, vv, uv, pixel^2.
    """

    name = "dot"
    fitted = 8
    toned = False

    def shape(self, centre: np.ndarray, radius: float, angle: float) -> np.ndarray:
        return np.array([*centre, radius**-2, radius**-2, 0.0, TYPICAL_BLUR**2, TYPICAL_BLUR**2, 0.0])

    def values(self, shape: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y = u - shape[0], v - shape[1]
        m, covariance = shape[2:5], shape[5:8]
        mx, my = m[0] * x + m[2] * y, m[1] * y + m[2] * x
        length = np.sqrt(mx * mx + my * my) + TINY
        cos, sin = mx / length, my / length
        distance = (0.5 * (x * mx + y * my - 1.0) / length).clip(-FAR, FAR)
        normals = np.stack([cos * cos, sin * sin, 2.0 * cos * sin])
        value, slope, bend = edge(distance, np.maximum(covariance @ normals, SHARPEST**2), cos, sin)
        derivatives = [
            -cos * slope,
            -sin * slope,
            *(0.5 * slope / length * np.stack([x * x, y * y, 2.0 * x * y])),
            *(bend * normals),
        ]
        return value, np.stack(derivatives)

    def inside(self, shape: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        x, y = u - shape[0], v - shape[1]
        m = shape[2:5]
        mx, my = m[0] * x + m[2] * y, m[1] * y + m[2] * x
        return x * mx + y * my - 1.0 < 2.0 * self._margin(shape) * np.hypot(mx, my)

    def reach(self, shape: np.ndarray) -> np.ndarray:
        return np.sqrt(np.diag(np.linalg.inv(_matrix(shape[2:5])))) + self._margin(shape)

    def radius(self, shape: np.ndarray) -> float:
        return float(np.linalg.det(_matrix(shape[2:5])) ** -0.25)

    def bounded(self, shape: np.ndarray) -> np.ndarray:
        largest = float(np.linalg.norm(shape[2:5]))
        m, covariance = _between(shape[2:5], FLATTEST * largest, largest), shape[5:8]
        return np.concatenate([shape[:2], m, _between(covariance, SHARPEST**2, float(1.0 / np.min(m[:2])))])

    def measured(self, shape: np.ndarray, image: np.ndarray) -> np.ndarray:
        return shape

    def template(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        distance = np.hypot(x, y)
        return np.where(distance < 1.0, -1.0, np.where(distance < GROUND, 1.0 / (GROUND**2 - 1.0), 0.0)) + 0.0j

    def _blur(self, shape: np.ndarray) -> float:
        """The largest standard deviation of the image of a point, pixel."""
        return float(np.sqrt(np.linalg.eigvalsh(_matrix(shape[5:8]))[-1]))

    def _margin(self, shape: np.ndarray) -> float:
        """How far beyond the edge the ground is looked at, pixel."""
        return float(max(SEEN_BLUR * self._blur(shape), SEEN_GROUND * self.radius(shape)))


def _matrix(values: np.ndarray) -> np.ndarray:
    return np.array([[values[0], values[2]], [values[2], values[1]]])


def _between(values: np.ndarray, least: float, most: float) -> np.ndarray:
    """A symmetric matrix with its eigenvalues brought between two numbers."""
    eigenvalues, vectors = np.linalg.eigh(_matrix(values))
    bounded = vectors * eigenvalues.clip(least, most) @ vectors.T
    return np.array([bounded[0, 0], bounded[1, 1], bounded[0, 1]])
