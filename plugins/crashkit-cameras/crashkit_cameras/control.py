"""Control points: whether they can calibrate a camera, and what of the volume and of the images they cover."""

import numpy as np
import xarray as xr
from attrs import frozen
from scipy.spatial import ConvexHull, Delaunay

from crashkit.errors import CrashkitError

LEAST_POINTS = 6
LEAST_DEPTH = 0.01
"""Smallest extent of the points over their largest, below which they count as lying in a plane."""
AXES = ["x", "y", "z"]


@frozen(eq=False)
class Control:
    """Points of known place and their images.

    Attributes:
        points: (point, 3), m.
        std: (point,), m, standard deviation of the survey, 0 where it is exact.
        image: (view, point, 2), pixel, NaN where hidden.
        views, names: of the views and of the points.
    """

    points: np.ndarray
    std: np.ndarray
    image: np.ndarray
    views: tuple[str, ...]
    names: tuple[str, ...]

    @property
    def seen(self) -> np.ndarray:
        """Which readings there are, (view, point)."""
        return np.isfinite(self.image).all(axis=2)

    def select(self, view: int) -> "Control":
        """One view."""
        return Control(self.points, self.std, self.image[view : view + 1], self.views[view : view + 1], self.names)


def control_of(instrument: xr.Dataset) -> Control:
    """The control points of a camera group.

    Raises CrashkitError where they cannot calibrate a view: too few, in a plane, or not in space; it says which and why.
    """
    axes = instrument["axis"].values.tolist()
    if axes != AXES:
        raise CrashkitError(f"camera: expected control_position along the axes x, y, z, found {', '.join(axes)}")
    points = instrument["control_position"].transpose("control_point", "axis").values.astype(float)
    std = instrument["control_position_std"].values if "control_position_std" in instrument else np.zeros(len(points))
    image = instrument["control_image"].transpose("view", "control_point", "image_axis").values.astype(float)
    views, names = labels(instrument, "view"), labels(instrument, "control_point")
    control = Control(points, np.asarray(std, dtype=float), image, views, names)
    for view, seen in zip(control.views, control.seen, strict=True):
        _refuse(view, points[seen])
    return control


def labels(instrument: xr.Dataset, dim: str) -> tuple[str, ...]:
    """The labels of a dimension, or numbers from 1 where it has none."""
    if dim in instrument.variables:
        return tuple(str(name) for name in instrument[dim].values)
    return tuple(str(number + 1) for number in range(instrument.sizes[dim]))


def image_coverage(control: Control, half_diagonal: np.ndarray) -> np.ndarray:
    """The share of each image that the hull of its control points covers, (view,); images taken for squares."""
    hulls = [ConvexHull(image[seen]).volume for image, seen in zip(control.image, control.seen, strict=True)]
    return np.array(hulls) / (2.0 * half_diagonal**2)


def inside(control: Control, positions: np.ndarray) -> np.ndarray:
    """Which positions (..., 3) lie within the hull of the control points; outside it, a camera extrapolates."""
    seen = control.points[control.seen.any(axis=0)]
    known = np.isfinite(positions).all(axis=-1)
    return np.asarray(known & (Delaunay(seen).find_simplex(np.where(known[..., None], positions, 0.0)) >= 0))


def _refuse(view: str, points: np.ndarray) -> None:
    expected = f'camera: view "{view}": expected at least {LEAST_POINTS} control points, well spread and not in a plane'
    different = len(np.unique(points, axis=0))
    if different < LEAST_POINTS:
        raise CrashkitError(f"{expected}, found {different}")
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False) / np.sqrt(len(points))
    for dimension, shape in ((1, "a line"), (2, "a plane")):
        if extents[dimension] < LEAST_DEPTH * extents[0]:
            raise CrashkitError(f"{expected}, found {len(points)} within {_length(extents[dimension])} of {shape}")


def _length(metres: float) -> str:
    return f"{1e3 * metres:.2g} mm"


def marker_images(instrument: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """The markers' images (view, time x marker, 2), NaN where hidden, and their std (time x marker,), NaN where not stated."""
    image = instrument["image_position"].transpose("view", "time", "marker", "image_axis").values.astype(float)
    views, times, markers, _ = image.shape
    image = np.where(np.isfinite(image).all(axis=3, keepdims=True), image, np.nan)
    known = "image_position_std" in instrument
    std = instrument["image_position_std"].values.astype(float) if known else np.full(markers, np.nan)
    return image.reshape(views, times * markers, 2), np.tile(std, times)
