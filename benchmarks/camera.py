"""Cameras: how far reconstructed points are off, beside the direct linear transformation, OpenCV and the true cameras.

A synthetic laboratory of 1024 x 1024 pixels, focal length 1300 pixels, seven metres away, 0.3 pixel of noise, radial and
decentring distortion. Each seed draws other lenses, control points and noise, and 400 points to be found in the volume.
The root mean square error in space of the 400 is measured; of twelve seeds the median and the worst are reported.

"DLT 11" and "DLT 16" are the paper's coefficients without further knowledge; OpenCV's `calibrateCamera` starts from the
former, as it needs a guess, with k3 fixed at 0 and as many iterations as it likes. Its points, and those of the true
cameras, are solved by maximum likelihood.
"""

from collections.abc import Callable
from importlib import import_module
from statistics import median
from typing import Any

import numpy as np
import xarray as xr

from benchmarks import Row, pair
from crashkit_cameras import calibrate, make_laboratory, triangulate
from crashkit_cameras.control import control_of, marker_images
from crashkit_cameras.dlt import cameras_of, fit_linear, solve_points
from crashkit_cameras.laboratory import HALF_VOLUME, Laboratory
from crashkit_cameras.prior import UNKNOWN
from crashkit_cameras.projection import Cameras, join
from crashkit_cameras.triangulation import triangulate_points

cv2: Any
try:
    cv2 = import_module("cv2")
except ImportError:
    cv2 = None

CASES = ((2, 8), (2, 12), (2, 20), (2, 40), (4, 40))
"""Cameras and control points."""
SEEDS = range(12)
POINTS = 400
INNER = 0.93
"""Extent of the volume in which points are sought over that of the control points."""


def run() -> list[Row]:
    """Median and worst error of each case beside each peer, and the time of a calibration."""
    return [*(row for views, points in CASES for row in _rows(views, points)), *_time_rows()]


def errors(views: int, control_points: int, seed: int) -> dict[str, float]:
    """The error of each method in one draw, mm; none of OpenCV where it is not installed."""
    lab, group, truth = draw(views, control_points, seed)
    methods: dict[str, Callable[[], np.ndarray]] = {
        "crashkit": lambda: triangulate(group)["position"].values[0],
        "DLT 11": lambda: solve_points(linear(group), _markers(group)),
        "DLT 16": lambda: _solved(calibrate(group, markers=False, prior=UNKNOWN).cameras, group),
        "true cameras": lambda: _solved(lab.cameras, group),
    }
    if cv2:
        methods["OpenCV"] = lambda: _solved(opencv_cameras(group), group)
    return {name: _rmse(method(), truth) for name, method in methods.items()}


def draw(views: int, control_points: int, seed: int) -> tuple[Laboratory, xr.Dataset, np.ndarray]:
    """A laboratory, the camera group of points in it, and where these really are, (point, 3)."""
    lab = make_laboratory(views, control_points, seed)
    random = np.random.default_rng([seed, 1])
    truth = random.uniform(-INNER, INNER, (POINTS, 3)) * HALF_VOLUME
    return lab, lab.record_points(truth[None], np.zeros(1), random), truth


def linear(group: xr.Dataset) -> np.ndarray:
    """The eleven coefficients of each view, (view, 11)."""
    control = control_of(group)
    return np.stack(
        [fit_linear(control.points[s], i[s]).coefficients for s, i in zip(control.seen, control.image, strict=True)]
    )


def opencv_cameras(group: xr.Dataset) -> Cameras:
    """OpenCV's calibration of each view, from the linear solution as a first guess."""
    control = control_of(group)
    guess = cameras_of(linear(group), control.points.mean(axis=0))
    return join([_opencv_camera(control.points, image, guess, view) for view, image in enumerate(control.image)])


def _opencv_camera(points: np.ndarray, image: np.ndarray, guess: Cameras, view: int) -> Cameras:
    seen = np.isfinite(image).all(axis=1)
    focal, (u, v) = guess.focal[view], guess.centre[view]
    inner = np.array([[focal, 0.0, u], [0.0, focal * guess.aspect[view], v], [0.0, 0.0, 1.0]])
    flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_K3
    until = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 1000, 1e-12)
    known, seen_at = [points[seen].astype(np.float32)], [image[seen].astype(np.float32)]
    _, inner, lens, turn, shift = cv2.calibrateCamera(
        known, seen_at, (1024, 1024), inner, np.zeros(5), flags=flags, criteria=until
    )
    rotation = cv2.Rodrigues(turn[0])[0]
    k1, k2, p1, p2, k3 = np.ravel(lens)[:5]
    return Cameras(
        rotation=rotation[None],
        position=-(rotation.T @ shift[0]).reshape(1, 3),
        focal=inner[:1, 0],
        aspect=inner[1:2, 1] / inner[0, 0],
        skew=np.zeros(1),
        centre=inner[None, :2, 2],
        distortion=np.array([[k1, k2, k3, p1, p2]]),
    )


def _solved(cameras: Cameras, group: xr.Dataset) -> np.ndarray:
    image = _markers(group)
    exact = np.zeros((16 * len(cameras), 16 * len(cameras)))
    return triangulate_points(cameras, exact, image, np.full(image.shape[:2], 1e3)).position


def _markers(group: xr.Dataset) -> np.ndarray:
    return marker_images(group)[0]


def _rmse(found: np.ndarray, truth: np.ndarray) -> float:
    return float(1e3 * np.sqrt(np.mean(np.sum((found - truth) ** 2, axis=1))))


def _rows(views: int, points: int) -> list[Row]:
    draws = [errors(views, points, seed) for seed in SEEDS]
    rows = []
    ways: dict[str, Callable[[list[float]], float]] = {"median": median, "worst": max}
    for name, over in ways.items():
        ours = over([one["crashkit"] for one in draws])
        for peer in ("OpenCV", "DLT 11", "DLT 16", "true cameras"):
            theirs = over([one[peer] for one in draws]) if peer in draws[0] else None
            rows.append(Row(f"{views} cameras, {points} control points: {name}", "error", "mm", ours, peer, theirs))
    return rows


def _time_rows() -> list[Row]:
    _, group, _ = draw(2, 40, 0)
    ours, theirs = pair(lambda: calibrate(group), (lambda: opencv_cameras(group)) if cv2 else None)
    return [Row("calibration of 2 cameras, 40 control points", "time", "s", ours, "OpenCV", theirs)]
