"""Calibration: the cameras of a group, from its control points and from the markers that several views saw."""

import numpy as np
import xarray as xr
from attrs import evolve, frozen
from scipy.stats import chi2

from crashkit_cameras.bundle import Estimate, Readings, adjust, posterior_cost
from crashkit_cameras.control import Control, control_of, image_coverage, marker_images
from crashkit_cameras.dlt import LINEAR, fit_linear
from crashkit_cameras.noise import USUAL, blunders, first_std, updated_std
from crashkit_cameras.prior import DISTORTION, Expectation, Frame, Prior, expectation, frame_of
from crashkit_cameras.projection import PARAMETERS, Cameras, project
from crashkit_cameras.result import Calibration
from crashkit_cameras.start import start_cameras
from crashkit_cameras.triangulation import excess_noise, triangulate_points

IDEAL = Prior()
MARKERS = 500
"""How many marker images are enough to steady the cameras."""
ROUNDS = 20
"""Of fitting and judging the noise by turns."""
SETTLED = 0.02
"""A relative change of the noise that matters no more."""
IMPROBABLE = 1e-4
FREE_NUMBERS = 10
"""About how many numbers of a camera the readings determine."""


@frozen(eq=False)
class _Fit:
    """Cameras and points, the readings with the noise that they turned out to have, and what was expected."""

    estimate: Estimate
    readings: Readings
    expectation: Expectation


def calibrate(instrument: xr.Dataset, markers: bool = True, prior: Prior = IDEAL) -> Calibration:
    """Calibrate the cameras of a group.

    First the eleven coefficients of each view by linear least squares; from them the principal point, and with it all
    sixteen by iteration: the two stages of Mizzi & Jezequel (1992), equations (12) to (15). The iteration goes on to the
    most probable cameras, given the readings, their noise (estimated with them), and the `prior`, which settles what few or
    badly spread control points leave open. Markers that two views or more saw at the same time must be where their rays
    meet: that steadies the cameras further.

    Arguments:
        instrument: a camera group; `image_size` (view, image_axis) helps, and `control_position_std` and
            `image_position_std` count where they are given.
        markers: whether to use them.
        prior: what is known of the cameras.

    Raises CrashkitError where the control points cannot calibrate a view.
    """
    control = control_of(instrument)
    linear = [fit_linear(control.points[s], i[s]) for s, i in zip(control.seen, control.image, strict=True)]
    recorded, std = _marker_readings(instrument) if markers else (control.image[:, :0], np.zeros(0))
    frame = frame_of(np.concatenate([control.image, recorded], axis=1), _image_size(instrument))
    cameras = start_cameras(control, frame, prior)
    expected = expectation(prior, frame, cameras.focal)
    alone = _from_control(control, cameras, expected)
    fit = _with_markers(alone, expected, recorded, std) if recorded.size else alone
    contradiction = fit is not alone and _contradict(alone, fit)
    return _judged(control, frame, [one.condition for one in linear], alone if contradiction else fit, contradiction)


def _from_control(control: Control, cameras: Cameras, expected: Expectation) -> _Fit:
    readings = Readings(control.image, np.full(control.seen.shape, USUAL), control.points, control.std)
    readings = evolve(readings, std=first_std(cameras, readings))
    estimate = adjust(cameras, control.points, readings, expected)
    return _simplest(_settled(_Fit(estimate, readings, expected), np.zeros(0)), np.zeros(0))


def _with_markers(alone: _Fit, expected: Expectation, recorded: np.ndarray, std: np.ndarray) -> _Fit:
    """Control points and markers together; `std` (point,) of the markers' readings is NaN where it is not known."""
    control = alone.readings
    cameras, covariance = alone.estimate.cameras, alone.estimate.covariance
    marker_std = control.std[:, :1] * np.ones(len(std))
    marker_std *= excess_noise(cameras, covariance, recorded, marker_std)
    marker_std = np.where(np.isfinite(std), std, marker_std)
    found = triangulate_points(cameras, covariance, recorded, marker_std)
    size = np.ptp(alone.estimate.points, axis=0).max()
    with np.errstate(invalid="ignore"):
        believed = np.trace(found.covariance, axis1=1, axis2=2) < size**2
    recorded, places, marker_std = recorded[:, believed], found.position[believed], marker_std[:, believed]
    readings = Readings(
        np.concatenate([control.image, np.where(found.used[:, believed, None], recorded, np.nan)], axis=1),
        np.concatenate([control.std, marker_std], axis=1),
        np.concatenate([control.known, places]),
        np.concatenate([control.known_std, np.full(len(places), np.inf)]),
    )
    start = np.concatenate([alone.estimate.points, places])
    estimate = adjust(cameras, start, readings, expected)
    fit = _Fit(estimate, readings, expected)
    return _simplest(_settled(fit, std[believed]), std[believed]) if np.isfinite(estimate.cost) else fit


def _settled(fit: _Fit, marker_std: np.ndarray) -> _Fit:
    """Fit and judge the noise by turns, until it changes no more; what is known of the markers' noise stays."""
    estimate, readings = fit.estimate, fit.readings
    control = np.isfinite(readings.known_std)
    for _ in range(ROUNDS):
        std = updated_std(estimate, readings, fit.expectation, control)
        std[:, ~control] = np.where(np.isfinite(marker_std), marker_std, std[:, ~control])
        change = np.abs(np.log(std / readings.std)).max()
        readings = evolve(readings, std=std)
        estimate = adjust(estimate.cameras, estimate.points, readings, fit.expectation)
        if change < SETTLED:
            break
    return _Fit(estimate, readings, fit.expectation)


def _simplest(fit: _Fit, marker_std: np.ndarray) -> _Fit:
    """The fit without distortion, where the readings make that the more probable.

    The odds are the density of no distortion after the readings over the one before (Dickey, Ann. Math. Stat. 42, 1971,
    204-223).
    """
    if not np.isfinite(fit.expectation.scale[:, DISTORTION]).all():
        return fit
    distortion = fit.estimate.cameras.distortion
    columns = np.arange(fit.estimate.covariance.shape[0]).reshape(len(distortion), -1)[:, DISTORTION].ravel()
    covariance = fit.estimate.covariance[np.ix_(columns, columns)]
    after = -0.5 * distortion.ravel() @ np.linalg.solve(covariance, distortion.ravel())
    after -= 0.5 * np.linalg.slogdet(2.0 * np.pi * covariance)[1]
    if after < fit.expectation.log_density_undistorted():
        return fit
    cameras = evolve(fit.estimate.cameras, distortion=np.zeros_like(distortion))
    expected = fit.expectation.without_distortion()
    estimate = adjust(cameras, fit.estimate.points, fit.readings, expected)
    return _settled(_Fit(estimate, fit.readings, expected), marker_std)


def _contradict(alone: _Fit, together: _Fit) -> bool:
    """Whether the markers draw the cameras further from the control points than chance does."""
    count = len(alone.readings.known)
    points = together.estimate.points[:count]
    cost = posterior_cost(together.estimate.cameras, points, alone.readings, alone.expectation)
    limit = chi2.isf(IMPROBABLE, FREE_NUMBERS * len(alone.estimate.cameras))
    return not 2.0 * (cost - alone.estimate.cost) < limit or not np.isfinite(together.estimate.cost)


def _judged(control: Control, frame: Frame, condition: list[float], fit: _Fit, contradiction: bool) -> Calibration:
    estimate, readings, count = fit.estimate, fit.readings, len(control.points)
    wrong, left = blunders(estimate, readings, fit.expectation)
    freedom = float(left.sum())
    covariance = estimate.covariance * (freedom / (freedom - 2.0) if freedom > 3.0 else 3.0)  # the noise is an estimate too
    variance = np.diag(estimate.covariance).reshape(-1, PARAMETERS)
    share = np.where(fit.expectation.held(), 0.0, 1.0 - fit.expectation.weight(estimate.cameras) * variance)
    residual = (control.image - project(estimate.cameras, estimate.points[:count])) * np.ones(2)
    return Calibration(
        control=control,
        cameras=estimate.cameras,
        covariance=covariance,
        control_std=readings.std[:, 0],
        marker_std=readings.std[:, -1],
        residual=residual,
        rejected=wrong[:, :count] & control.seen,
        condition=np.array(condition),
        from_readings=np.clip(share[:, LINEAR:], 0.0, 1.0),
        coverage=image_coverage(control, frame.half_diagonal),
        markers=len(readings.known) - count,
        contradiction=contradiction,
    )


def _image_size(instrument: xr.Dataset) -> np.ndarray | None:
    if "image_size" not in instrument:
        return None
    return np.asarray(instrument["image_size"].transpose("view", "image_axis").values, dtype=float)


def _marker_readings(instrument: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Some of the markers' images (view, point, 2) that two views or more saw, and their std (point,), NaN if not known."""
    recorded, std = marker_images(instrument)
    shared = np.flatnonzero(np.isfinite(recorded).all(axis=2).sum(axis=0) >= 2)
    some = np.sort(np.random.default_rng(0).permutation(shared)[:MARKERS])
    return recorded[:, some], std[some]
