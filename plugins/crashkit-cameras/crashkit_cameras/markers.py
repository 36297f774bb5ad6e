"""Markers in space from a camera group."""

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit_cameras.calibration import calibrate
from crashkit_cameras.control import inside, marker_images
from crashkit_cameras.result import Calibration
from crashkit_cameras.triangulation import Triangulation, excess_noise, triangulate_points


def triangulate(instrument: xr.Dataset, calibration: Calibration | None = None) -> xr.Dataset:
    """The positions of the markers of a camera group.

    Each is the most probable one, given its images in two views or more, their noise and the cameras' own uncertainty. A
    view that contradicts the others is left out; where that is not clear, the marker counts as hidden.

    Arguments:
        instrument: a camera group.
        calibration: of its cameras; omitted: `calibrate(instrument)`.

    Returns:
        `position` (time, marker, axis), m, NaN where fewer than two views agree; `position_std`, its standard deviation, and
        `position_noise`, the part of it that is independent from frame to frame, likewise; `rejected` (time, view, marker):
        readings that contradict the others; `extrapolated` (time, marker): outside the volume of the control points.
    """
    calibration = calibrate(instrument) if calibration is None else calibration
    found = triangulation(instrument, calibration)
    times, markers = instrument.sizes["time"], instrument.sizes["marker"]
    known = np.isfinite(found.position).all(axis=1)
    dims = ("time", "marker", "axis")
    metre = {"units": "m"}
    variables = {
        "position": xr.Variable(dims, found.position.reshape(times, markers, 3), metre),
        "position_std": xr.Variable(dims, _std(found.covariance).reshape(times, markers, 3), metre),
        "position_noise": xr.Variable(dims, _std(found.noise).reshape(times, markers, 3), metre),
        "rejected": xr.Variable(("time", "view", "marker"), found.rejected.reshape(-1, times, markers).transpose(1, 0, 2)),
        "extrapolated": xr.Variable(
            ("time", "marker"), (known & ~inside(calibration.control, found.position)).reshape(times, markers)
        ),
    }
    return xr.Dataset(variables, {name: instrument[name] for name in ("time", "marker", "axis")})


def film_group(instrument: xr.Dataset, markers: xr.Dataset) -> xr.Dataset:
    """A film group from a camera group and its markers' positions; each marker's std is the mean over time and axes."""
    std = ((markers["position_noise"] ** 2).mean(("time", "axis")) ** 0.5).assign_attrs(units="m")
    variables = {"position": markers["position"], "position_std": std}
    return xr.Dataset(
        variables | {name: instrument[name] for name in ("marker_body", "marker_point")}, attrs={"observer": "film"}
    )


def triangulation(instrument: xr.Dataset, calibration: Calibration) -> Triangulation:
    """The markers' positions with all that is known of their errors, one after the other, time by time.

    Raises CrashkitError where there is only one view.
    """
    image, stated = marker_images(instrument)
    if len(image) < 2:
        raise CrashkitError("camera: expected two views or more, as one does not tell how far away a marker is, found 1")
    std = calibration.marker_std[:, None] * np.ones(image.shape[1])
    if not calibration.markers:
        std *= excess_noise(calibration.cameras, calibration.covariance, image, std)
    std = np.where(np.isfinite(stated), stated, std)
    return triangulate_points(calibration.cameras, calibration.covariance, image, std)


def _std(covariance: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt(np.diagonal(covariance, axis1=1, axis2=2)))
