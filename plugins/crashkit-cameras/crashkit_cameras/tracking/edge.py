"""A straight edge between dark (-1) and bright (1) as a pixel sees it."""

import numpy as np
from scipy.special import erf

NARROWEST = 1e-3
SIGNS = np.array([1.0, -1.0, -1.0, 1.0])


def edge(
    distance: np.ndarray, variance: np.ndarray, cos: np.ndarray, sin: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    r"""The mean over a pixel's square of an edge blurred by a normal distribution.

        E(d) = (1 / p q) ∫∫ erf((d + s + t) / (σ √2)) ds dt,   |s| < p / 2, |t| < q / 2,

    with p = |cos| and q = |sin| the widths of the square's sides seen along the edge's normal. It is a second difference of
    the second integral of erf, hence exact however sharp the edge.

    Arguments:
        distance: of the pixel's middle from the edge, positive where it is bright, pixel.
        variance: σ², pixel^2; it, cos and sin are broadcast to the distances.
        cos, sin: of the angle of the edge's normal.

    Returns:
        E, its derivative to the distance, and its derivative to the variance.
    """
    p, q = np.maximum(np.abs(cos), NARROWEST), np.maximum(np.abs(sin), NARROWEST)
    total, difference = 0.5 * (p + q), 0.5 * (p - q)
    x = np.stack([distance + total, distance + difference, distance - difference, distance - total])
    sign = SIGNS.reshape(4, *(1,) * np.ndim(distance)) / (p * q)
    step = sign * erf(x / np.sqrt(2.0 * variance))
    bell = sign * np.sqrt(2.0 / np.pi * variance) * np.exp(-0.5 * x * x / variance)
    value = 0.5 * ((x * x + variance) * step + x * bell)
    return value.sum(axis=0), (x * step + bell).sum(axis=0), 0.5 * step.sum(axis=0)
