"""The quadrant target of crash tests: four sectors of a disc, bright and dark by turns."""

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.special import erf

from crashkit_cameras.tracking.edge import edge
from crashkit_cameras.tracking.pattern import Pattern

NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
PIXEL_VARIANCE = 1.0 / 12.0
"""pixel^2; of a place within a pixel."""
SHARPEST, TYPICAL_BLUR = 0.1, 0.7
"""pixel"""
MOST_CORRELATED = 0.95
RIM_DEVIATIONS, LEAST_INSIDE = 2.0, 0.7
"""How far from the rim pixels must be, in deviations of the blur; but so much of the reach is always looked at."""
LEAST_SEEN, MOST_SEEN, STEPS, NEAR_STEPS = 0.4, 1.6, 49, 5
"""Where along a line its end is looked for, in parts of the reach so far."""
SIDE = 0.25
"""How far beside the line, likewise."""


class Quadrant(Pattern):
    r"""Two straight lines that part bright from dark, each blurred.

    With the edges' values E, F (see `edge`), their distances a, b in units of their blur, and r the correlation of the
    blur across one with the blur across the other:

        m = E F + 4 ∫_0^r φ(a, b; s) ds,   φ the density of two normal deviates with correlation s,

    which is the mean of sign(a + z) sign(b + w) over such deviates z, w (Plackett 1954, doi:10.1093/biomet/41.3-4.351).
    Straight lines stay straight in perspective: their crossing is the target's true middle however it is seen.

    The shape: centre u, v; angles of the two lines' normals, rad; variance of the blur across each, pixel^2; r; and, not
    fitted, how far from the centre each line is seen, pixel.
    """

    name = "quadrant"
    fitted = 7
    toned = True

    def shape(self, centre: np.ndarray, radius: float, angle: float) -> np.ndarray:
        return np.array([*centre, angle, angle + np.pi / 2, TYPICAL_BLUR**2, TYPICAL_BLUR**2, 0.0, radius, radius])

    def values(self, shape: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y = u - shape[0], v - shape[1]
        (cos, sin), r = _normals(shape), shape[6]
        distance, variance = cos * x + sin * y, shape[4:6, None]
        (first, second), slope, bend = edge(distance, variance, cos, sin)
        spread = np.sqrt(variance + PIXEL_VARIANCE)
        a, b = distance / spread
        joint = 2.0 * r * WEIGHTS @ _density(a, b, 0.5 * r * (1.0 + NODES[:, None]))
        to_first, to_second = slope * [second, first] + _joint_slopes(a, b, r) / spread
        along_first, along_second = cos * y - sin * x
        derivatives = [
            *(-cos[0] * to_first - cos[1] * to_second, -sin[0] * to_first - sin[1] * to_second),
            *(along_first * to_first, along_second * to_second),
            *(bend * [second, first]),
            4.0 * _density(a, b, r),
        ]
        return first * second + joint, np.stack(derivatives)

    def inside(self, shape: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        rim = RIM_DEVIATIONS * self._blur(shape) + 0.5
        reach = np.maximum(shape[7:9] - rim, LEAST_INSIDE * shape[7:9])
        x, y = np.linalg.solve(_axes(shape) * reach, np.stack([(u - shape[0]).ravel(), (v - shape[1]).ravel()]))
        return (x * x + y * y < 1.0).reshape(u.shape)

    def reach(self, shape: np.ndarray) -> np.ndarray:
        return np.hypot(*(_axes(shape) * shape[7:9]).T)

    def radius(self, shape: np.ndarray) -> float:
        return float(np.sqrt(abs(np.linalg.det(_axes(shape) * shape[7:9]))))

    def bounded(self, shape: np.ndarray) -> np.ndarray:
        bounded = shape.copy()
        bounded[4:6] = shape[4:6].clip(SHARPEST**2, np.max(shape[7:9]) ** 2)
        bounded[6] = shape[6].clip(-MOST_CORRELATED, MOST_CORRELATED)
        return bounded

    def measured(self, shape: np.ndarray, image: np.ndarray) -> np.ndarray:
        beside = SIDE * np.max(shape[7:9]) + self._blur(shape)
        reach = [_seen_along(image, shape, line, beside) for line in (0, 1)]
        return np.append(shape[:7], reach)

    def template(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.where(x * x + y * y < 1.0, 1j * np.exp(-2j * np.arctan2(y, x)), 0.0)

    def _blur(self, shape: np.ndarray) -> float:
        """The largest standard deviation of the image of a point, pixel."""
        return float(np.sqrt(np.max(shape[4:6])))


def _seen_along(image: np.ndarray, shape: np.ndarray, line: int, beside: float) -> float:
    """How far from the centre the image still differs by half as much across a line as near the centre, pixel."""
    along, across = _axes(shape)[:, line], np.array([np.cos(shape[2 + line]), np.sin(shape[2 + line])])
    far = shape[7 + line] * np.linspace(LEAST_SEEN, MOST_SEEN, STEPS)
    arms = [shape[:2, None] + sign * np.outer(along, far) for sign in (1.0, -1.0)]
    sides = [[_bright(image, arm + side * beside * across[:, None]) for side in (1.0, -1.0)] for arm in arms]
    difference = sides[0][0] - sides[0][1] - sides[1][0] + sides[1][1]
    gone = np.abs(difference) < 0.5 * np.abs(np.median(difference[:NEAR_STEPS]))
    return float(far[np.argmax(gone)] if gone.any() else far[-1])


def _bright(image: np.ndarray, points: np.ndarray) -> np.ndarray:
    return map_coordinates(image, points[::-1], order=1, mode="nearest", output=float)


def _normals(shape: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and sine of the angles of the two lines' normals, (line, 1)."""
    return np.cos(shape[2:4, None]), np.sin(shape[2:4, None])


def _axes(shape: np.ndarray) -> np.ndarray:
    """Unit vectors along the two lines, one a column."""
    return np.array([-np.sin(shape[2:4]), np.cos(shape[2:4])])


def _density(a: np.ndarray, b: np.ndarray, r: np.ndarray) -> np.ndarray:
    """The density of two normal deviates with correlation r."""
    rest = 1.0 - r * r
    return np.exp(-0.5 * (a * a - 2.0 * r * a * b + b * b) / rest) / (2.0 * np.pi * np.sqrt(rest))


def _joint_slopes(a: np.ndarray, b: np.ndarray, r: float) -> np.ndarray:
    """The derivatives to a and b of 4 ∫_0^r φ(a, b; s) ds."""
    here, there = np.stack([a, b]), np.stack([b, a])
    away = erf((there - r * here) / np.sqrt(2.0 * (1.0 - r * r))) - erf(there / np.sqrt(2.0))
    return np.sqrt(2.0 / np.pi) * np.exp(-0.5 * here * here) * away
