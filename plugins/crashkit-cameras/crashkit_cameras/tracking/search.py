"""Where in an image a target could be: the pattern's correlation with the image, however it is turned."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.fft import irfft2, next_fast_len, rfft2
from scipy.ndimage import maximum_filter

from crashkit_cameras.tracking.pattern import Pattern

LEAST_CORRELATION = 0.5
FINE_RADIUS = 5.0
"""pixel; an image is made coarser until what is looked for is smaller than twice this."""
FLAT = 1e-3
"""Of the image's variation; less is no pattern."""


class Candidate(NamedTuple):
    """A place where a target could be; lengths in pixel, angle in rad."""

    centre: np.ndarray
    radius: float
    angle: float
    correlation: float

    def shape(self, pattern: Pattern) -> np.ndarray:
        """Of the target, seen square on."""
        return pattern.shape(self.centre, self.radius, self.angle)


def search(pattern: Pattern, image: np.ndarray, radii: Sequence[float]) -> list[Candidate]:
    """The places where the image resembles a pattern with one of the radii, pixel; the likest first."""
    found = [candidate for radius in radii for candidate in _search_one(pattern, image, radius)]
    return sorted(found, key=lambda candidate: -candidate.correlation)


def search_around(
    pattern: Pattern, image: np.ndarray, radii: Sequence[float], point: np.ndarray, within: float
) -> list[Candidate]:
    """The same, no further from a point than `within`, pixel."""
    margin = within + 2.0 * max(radii)
    low = np.maximum(np.floor(point - margin), 0).astype(int)
    high = np.maximum(np.ceil(point + margin) + 1, 0).astype(int)
    candidates = search(pattern, image[low[1] : high[1], low[0] : high[0]], radii)
    moved = [candidate._replace(centre=candidate.centre + low) for candidate in candidates]
    return [candidate for candidate in moved if np.hypot(*(candidate.centre - point)) <= within]


def correlation(pattern: Pattern, image: np.ndarray, radius: float) -> np.ndarray:
    r"""The correlation of an image with a pattern around each pixel: complex, its modulus 0 to 1.

        c = Σ h (I - mean) / √(s Σ w (I - mean)^2),   s = (Σ |h|^2 + |Σ h^2|) / 2,

    with h the pattern's template, w its support, and s the square of the best turned template. The argument of c is -2
    times the angle by which a quadrant is turned.
    """
    template, support = _kernels(pattern, radius)
    reach = template.shape[0] // 2
    shape = tuple(next_fast_len(size + 2 * reach, real=True) for size in image.shape)
    bright = image - np.mean(image)
    spectrum, square = rfft2(bright, shape), rfft2(bright * bright, shape)

    def summed(of: np.ndarray, kernel: np.ndarray) -> np.ndarray:
        whole = irfft2(of * rfft2(kernel[::-1, ::-1], shape), shape)
        return whole[reach : reach + image.shape[0], reach : reach + image.shape[1]]

    count = support.sum()
    variation = summed(square, support) - summed(spectrum, support) ** 2 / count
    size = 0.5 * (np.sum(np.abs(template) ** 2) + np.abs(np.sum(template**2)))
    floor = FLAT * count * np.var(bright) + np.finfo(float).tiny
    matched = summed(spectrum, template.real) + 1j * summed(spectrum, template.imag)
    return matched / np.sqrt(size * np.maximum(variation, floor))


def _search_one(pattern: Pattern, image: np.ndarray, radius: float) -> list[Candidate]:
    factor = max(int(radius / FINE_RADIUS), 1)
    coarse = _coarser(image, factor)
    if min(coarse.shape) < 2 * radius / factor:
        return []
    map_ = correlation(pattern, coarse, radius / factor)
    strength = np.abs(map_)
    peak = strength == maximum_filter(strength, size=2 * int(radius / factor) + 1)
    rows, columns = np.nonzero(peak & (strength > LEAST_CORRELATION))
    return [
        Candidate((np.array([u, v]) + 0.5) * factor - 0.5, radius, -0.5 * np.angle(map_[v, u]), strength[v, u])
        for u, v in zip(columns, rows, strict=True)
    ]


def _kernels(pattern: Pattern, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Template, without a mean, and its support, on the pixels around a centre."""
    pixels = np.arange(-int(2 * radius), int(2 * radius) + 1) / radius
    template = pattern.template(*np.meshgrid(pixels, pixels))
    support = (template != 0.0).astype(float)
    return template - support * template.sum() / support.sum(), support


def _coarser(image: np.ndarray, factor: int) -> np.ndarray:
    """The mean over squares of pixels."""
    height, width = (size // factor * factor for size in image.shape)
    squares = image[:height, :width].astype(float).reshape(height // factor, factor, width // factor, factor)
    return squares.mean(axis=(1, 3))
