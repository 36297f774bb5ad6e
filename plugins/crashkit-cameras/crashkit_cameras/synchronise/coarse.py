"""The whole offset of a view against another, from where the rays of common markers come nearest to each other."""

import numpy as np
from attrs import evolve

from crashkit_cameras.dlt import coefficients_of, solve_points
from crashkit_cameras.projection import Cameras, project

UNDISTORTING = 8
LEAST_COMMON = 0.3
"""Of the points that both views see at their own stamps."""
RIVAL = 1.5
"""Another offset at which the rays meet with less than so many times the error could be meant as well; or with the error that
half a step makes."""
HILL = 2.0
"""How much higher the error is between two offsets that are not the same."""


def undistorted(cameras: Cameras, image: np.ndarray) -> np.ndarray:
    """Where points (view, point, 2) would be in the images of cameras without distortion, by fixed-point iteration."""
    straight = evolve(cameras, distortion=np.zeros_like(cameras.distortion))
    found = image.copy()
    for view in range(len(cameras)):
        camera = cameras.select(slice(view, view + 1))
        for _ in range(UNDISTORTING):
            found[view] += image[view] - project(camera, _on_rays(straight, view, found[view]))[0]
    return found


def _on_rays(cameras: Cameras, view: int, image: np.ndarray) -> np.ndarray:
    """A point (point, 3) on each ray of a view's image (point, 2), at unit depth."""
    down = (image[:, 1] - cameras.centre[view, 1]) / (cameras.focal[view] * cameras.aspect[view])
    right = (image[:, 0] - cameras.centre[view, 0]) / cameras.focal[view] - cameras.skew[view] * down
    return cameras.position[view] + np.stack([right, down, np.ones_like(down)], axis=1) @ cameras.rotation[view]


def coarse_offset(cameras: Cameras, stamps: np.ndarray, image: np.ndarray, offsets: np.ndarray) -> tuple[float, bool]:
    """The offset of a second view against the first at which the rays come nearest, and whether another would do as well.

    Arguments:
        cameras: two views, without distortion.
        stamps: (time,), s.
        image: (2, time, marker, 2), pixel, undistorted, NaN where hidden.
        offsets: to try, s, evenly spaced.
    """
    least = LEAST_COMMON * np.isfinite(image).all(axis=(0, 3)).sum()
    errors = np.array([_error(cameras, np.stack([image[0], shifted(stamps, image[1], one)]), least) for one in offsets])
    best = int(np.argmin(errors))
    return float(offsets[best]), _rivalled(errors, best)


def _rivalled(errors: np.ndarray, best: int) -> bool:
    """Whether beyond a hill the error is as low as at the best place, or as half a step beside it."""
    beside = max(errors[max(best - 1, 0)], errors[min(best + 1, len(errors) - 1)])
    low = max(RIVAL * errors[best], 0.5 * beside)
    for side in (errors[best:], errors[best::-1]):
        beyond = np.flatnonzero(side > HILL * low)
        if beyond.size and np.min(side[beyond[0] :]) < low:
            return True
    return False


def _error(cameras: Cameras, image: np.ndarray, least: float) -> float:
    """The median distance between points and the rays that should meet in them, pixel; infinite where there are too few."""
    flat = image.reshape(2, -1, 2)
    flat = flat[:, np.isfinite(flat).all(axis=(0, 2))]
    if flat.shape[1] <= least:
        return np.inf
    residual = flat - project(cameras, solve_points(coefficients_of(cameras), flat))
    return float(np.median(np.sqrt(np.sum(residual**2, axis=(0, 2)))))


def shifted(stamps: np.ndarray, image: np.ndarray, offset: float) -> np.ndarray:
    """A view's images (time, ...) at the times of the stamps, if its own are late by an offset; NaN beside hidden frames."""
    at = stamps + offset
    after = np.searchsorted(stamps, at).clip(1, len(stamps) - 1)
    part = (at - stamps[after - 1]) / (stamps[after] - stamps[after - 1])
    part[(part < -1e-9) | (part > 1.0 + 1e-9)] = np.nan
    part = part.reshape(-1, *(1,) * (image.ndim - 1))
    return (1.0 - part) * image[after - 1] + part * image[after]
