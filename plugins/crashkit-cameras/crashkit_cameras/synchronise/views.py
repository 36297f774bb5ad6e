"""Synchronisation of cameras by the motion of the markers that they see in common."""

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit_cameras.calibration import calibrate
from crashkit_cameras.control import labels
from crashkit_cameras.dlt import coefficients_of, solve_points
from crashkit_cameras.projection import PARAMETERS, Cameras, join
from crashkit_cameras.result import Calibration
from crashkit_cameras.synchronise.bundle import OWN, Linear, State, Views, linearised
from crashkit_cameras.synchronise.clocks import DRIFT, settled
from crashkit_cameras.synchronise.coarse import coarse_offset, shifted, undistorted
from crashkit_cameras.synchronise.spline import basis, choose_count, knots, through

WITHIN = 0.2
"""Of the film's length; how large an offset may be."""
STEPS_PER_FRAME = 2
ITERATIONS = 20
STILL = 1e-9
"""s"""
FIXED = 1e24
LEAST_POINTS = 6
MARGIN = 2.0
"""Frames by which the splines reach beyond the film."""
TINY = 1e-9


def synchronise_views(
    instrument: xr.Dataset,
    within: float | None = None,
    drift: float = DRIFT,
    reference: str | None = None,
    calibration: Calibration | None = None,
) -> xr.Dataset:
    """The views' clocks from the motion of markers that two or more views see.

    Each marker moves along a smooth curve. Curves, clocks and the cameras' remaining errors are those that explain all images
    best, by Gauss-Newton; where a view's rays and the marker's path lie in one plane with the other camera, its clock does not
    show. The number of functions in a curve is chosen by Akaike's criterion from the images themselves.

    Arguments:
        instrument: a camera group; `image_position_std` counts where it is given.
        within: how large an offset against the reference may be, s; omitted: a fifth of the film.
        drift: standard deviation of the clocks' rates against the reference's, as far as it is known beforehand.
        reference: the view whose clock is right; the first, if omitted.
        calibration: of the cameras; omitted: by the control points alone, as markers mislead where clocks differ.

    Returns:
        The clocks (see `clocks`), with the attributes `reference` and `normalised_residual`, the residual over its standard
        deviation. A view is not determined where its markers' motion leaves its clock open, or where two offsets explain the
        images alike.

    Raises CrashkitError where there is one view only, or no marker that two views see.
    """
    names = list(labels(instrument, "view"))
    if len(names) < 2:
        raise CrashkitError(f"camera: expected two views or more to synchronise, found {len(names)}")
    first = names.index(reference or names[0])
    calibration = calibration or calibrate(instrument, markers=False)
    stamps = instrument["time"].values
    within = within or WITHIN * float(stamps[-1] - stamps[0])
    image = instrument["image_position"].transpose("view", "time", "marker", "image_axis").values.astype(float)
    image = np.where(np.isfinite(image).all(axis=-1, keepdims=True), image, np.nan)

    offsets, ambiguous, points = _start(calibration.cameras, stamps, image, first, within)
    kept = np.isfinite(points).all(axis=2).sum(axis=0) >= LEAST_POINTS
    if not kept.any():
        raise CrashkitError("camera: expected markers that two views or more see, found none")
    std = instrument["image_position_std"].values[kept] if "image_position_std" in instrument else None
    views = _views(calibration, stamps, image[:, :, kept], std, offsets, _clock_information(len(names), first, within, drift))
    found = _solved(views, _first_state(views, offsets, points[:, kept]))
    return _result(views, found, names, first, within, ambiguous)


def _start(
    cameras: Cameras, stamps: np.ndarray, image: np.ndarray, first: int, within: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each view's whole offset, whether another would do as well, and the markers' places at the reference's stamps."""
    straight = evolve(cameras, distortion=np.zeros_like(cameras.distortion))
    flat = undistorted(cameras, image.reshape(len(image), -1, 2)).reshape(image.shape)
    count = int(np.ceil(within / np.median(np.diff(stamps))))
    trials = np.linspace(-within, within, 2 * STEPS_PER_FRAME * count + 1)
    offsets, ambiguous = np.zeros(len(image)), np.zeros(len(image), dtype=bool)
    for view in range(len(image)):
        if view != first:
            pair = _pair(straight, first, view)
            offsets[view], ambiguous[view] = coarse_offset(pair, stamps, flat[[first, view]], trials)
    together = np.stack([shifted(stamps, one, offset) for one, offset in zip(flat, offsets, strict=True)])
    points = solve_points(coefficients_of(straight), together.reshape(len(image), -1, 2))
    return offsets, ambiguous, points.reshape(*image.shape[1:3], 3)


def _pair(cameras: Cameras, one: int, other: int) -> Cameras:
    return join([cameras.select(slice(view, view + 1)) for view in (one, other)])


def _clock_information(count: int, first: int, within: float, drift: float) -> np.ndarray:
    """Inverse variances of offset and rate beforehand, (view, 2): none of the reference's clock."""
    information = np.tile([3.0 / within**2, 1.0 / drift**2], (count, 1))
    information[first] = FIXED
    return information


def _views(
    calibration: Calibration,
    stamps: np.ndarray,
    image: np.ndarray,
    std: np.ndarray | None,
    offsets: np.ndarray,
    clocks_known: np.ndarray,
) -> Views:
    """The readings, a spline with as many functions as they ask for, and the noise that is stated or, if not, remains."""
    markers = image.shape[2]
    count, noise = choose_count(stamps, image.transpose(1, 2, 0, 3).reshape(len(stamps), -1))
    if std is None:
        std = np.sqrt(np.mean(noise.reshape(markers, -1) ** 2, axis=1))
    margin = MARGIN * float(np.median(np.diff(stamps)))
    start, end = stamps[0] - max(offsets) - margin, stamps[-1] - min(offsets) + margin
    count = int(np.ceil(count * (end - start) / (stamps[-1] - stamps[0])))
    information = np.zeros((len(image), OWN, len(image), OWN))
    information[:, 2:, :, 2:] = _inverse(calibration.covariance).reshape(len(image), PARAMETERS, len(image), PARAMETERS)
    for view, known in enumerate(clocks_known):
        information[view, [0, 1], view, [0, 1]] = known
    size = len(image) * OWN
    epoch = float(0.5 * (stamps[0] + stamps[-1]))
    return Views(stamps, epoch, image, std, knots(start, end, count), calibration.cameras, information.reshape(size, size))


def _inverse(covariance: np.ndarray) -> np.ndarray:
    """The inverse of a covariance of numbers of very different size."""
    std = np.sqrt(np.diag(covariance))
    return np.asarray(np.linalg.pinv(covariance / np.outer(std, std), hermitian=True) / np.outer(std, std))


def _first_state(views: Views, offsets: np.ndarray, points: np.ndarray) -> State:
    own = np.zeros((len(offsets), OWN))
    own[:, 0] = offsets
    functions = basis(views.knots, views.stamps)
    splines = []
    for track in points.swapaxes(0, 1):
        known = np.isfinite(track).all(axis=1)
        splines.append(through(functions[known], track[known]).T)
    return State(own, np.array(splines))


def _solved(views: Views, state: State) -> tuple[State, Linear]:
    """Gauss-Newton's steps, halved where they make matters worse."""
    best, linear = state, linearised(views, state)
    state = linear.better
    for _ in range(ITERATIONS):
        trial = linearised(views, state)
        if trial.cost > linear.cost * (1.0 + TINY):
            state = best.towards(state, 0.5)
            continue
        moved = np.max(np.abs(state.own - best.own)[:, 0])
        best, linear, state = state, trial, trial.better
        if moved < STILL:
            break
    return best, linear


def _result(
    views: Views, found: tuple[State, Linear], names: list[str], first: int, within: float, ambiguous: np.ndarray
) -> xr.Dataset:
    state, linear = found
    freedom = linear.readings - state.splines.size - 2 * (len(names) - 1)
    excess = linear.square / freedom
    covariance = np.array([_clock_covariance(views, linear, view) for view in range(len(names))]) * max(excess, 1.0)
    covariance[first], clock = 0.0, state.own[:, :2].copy()
    clock[first] = 0.0
    covariance[ambiguous, 0, 0] = np.inf
    about = {"reference": names[first], "normalised_residual": float(np.sqrt(excess))}
    return settled(names, clock, covariance, views.epoch, within, **about)


def _clock_covariance(views: Views, linear: Linear, view: int) -> np.ndarray:
    """Of a view's offset and rate, without the certainty that noise pretends, and no worse than was known beforehand."""
    place = slice(view * OWN, view * OWN + 2)
    known = np.sqrt(np.diag(views.information)[place])
    information = np.linalg.inv(np.linalg.inv(linear.reduced)[place, place]) - linear.illusion[view]
    sizes, vectors = np.linalg.eigh(information / np.outer(known, known))
    return np.asarray(vectors / sizes.clip(min=1.0) @ vectors.T / np.outer(known, known))
