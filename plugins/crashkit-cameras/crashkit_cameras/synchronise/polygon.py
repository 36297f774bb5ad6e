"""Convex polygons: cut by half planes; their mean and covariance."""

import numpy as np


def cut(polygon: np.ndarray, normal: np.ndarray, limit: float) -> np.ndarray:
    """The part of a convex polygon (corner, 2), in order, in which normal · x <= limit; no corners where there is none."""
    height = polygon @ normal - limit
    corners = []
    for here, there, low, high in zip(polygon, np.roll(polygon, -1, axis=0), height, np.roll(height, -1), strict=True):
        if low <= 0.0:
            corners.append(here)
        if low * high < 0.0:
            corners.append(here + (there - here) * low / (low - high))
    return np.array(corners).reshape(-1, 2)


def moments(polygon: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and covariance of points that are equally likely everywhere in a convex polygon, by triangles from a corner."""
    first = polygon[0]
    a, b = polygon[1:-1] - first, polygon[2:] - first
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    weight = area / area.sum()
    mean = weight @ (a + b) / 3.0
    pairs = (a[:, :, None] * a[:, None]) + (b[:, :, None] * b[:, None]) + ((a + b)[:, :, None] * (a + b)[:, None])
    square = np.tensordot(weight, pairs, 1) / 12.0
    return first + mean, square - np.outer(mean, mean)
