"""Points from their images in two or more views, each weighted by its uncertainty."""

import numpy as np
from attrs import frozen
from scipy.stats import chi2

from crashkit_cameras.dlt import coefficients_of, solve_points
from crashkit_cameras.projection import Cameras, project_with_derivatives, project_with_point_derivatives

IMPROBABLE = 1e-7
"""A residual that only one point in so many has by chance is a blunder."""
CLEAR = 9.0
"""How much better leaving one view out must be than leaving out any other, in squared standard deviations."""
STEPS = 20
CLOSE = 1e-9
"""m; a step too short to matter."""
TINY = 1e-14
"""Of the information on a point, added so that a point at infinity does no harm."""
CHUNK = 4000
"""Points at a time, to bound the memory."""


@frozen(eq=False)
class Triangulation:
    """Points, and how far they may be off.

    Attributes:
        position: (point, 3), m; NaN where fewer than two views agree.
        noise: covariance from the noise of the point's own images, (point, 3, 3), m².
        response: how far the point moves with each standard deviation of the calibration's errors, (point, 3, error), m;
            these errors are common to all points.
        square: Σ of squared residuals in standard deviations, (point,).
        used: which readings the position rests on, (view, point).
        rejected: which readings contradict the others, (view, point).
    """

    position: np.ndarray
    noise: np.ndarray
    response: np.ndarray
    square: np.ndarray
    used: np.ndarray
    rejected: np.ndarray

    @property
    def covariance(self) -> np.ndarray:
        """Of each position, (point, 3, 3), m², noise and calibration together."""
        return np.asarray(self.noise + self.response @ self.response.transpose(0, 2, 1))

    @property
    def freedom(self) -> np.ndarray:
        """How many readings more than needed each point has, (point,)."""
        return np.asarray(2 * self.used.sum(axis=0) - 3)


def triangulate_points(cameras: Cameras, covariance: np.ndarray, image: np.ndarray, std: np.ndarray) -> Triangulation:
    """The most probable points, and their uncertainty; a view that contradicts two others or more is left out.

    Minimises e' S^-1 e, e the residuals of all views, S = diag(std²) + C Σ C' their covariance from the noise and from the
    cameras' own uncertainty. Where only two views saw a point and contradict each other, none of both is believed.

    Arguments:
        cameras: of V views.
        covariance: Σ, of the cameras' steps (`Cameras.moved`), (16 V, 16 V).
        image: (view, point, 2), pixel, NaN where hidden.
        std: of a reading, (view, point), pixel.
    """
    found = _solve(cameras, covariance, image, std)
    wrong = np.flatnonzero(_improbable(found))
    if len(wrong) == 0:
        return found
    trials = [_solve(cameras, covariance, _hidden(image[:, wrong], view), std[:, wrong]) for view in range(len(cameras))]
    square = np.array([np.where(trial.freedom > 0, trial.square, np.inf) for trial in trials])
    first, second = np.sort(square, axis=0)[:2]
    clear = second > first + CLEAR
    for view, trial in enumerate(trials):
        chosen = (square[view] == first) & clear & ~_improbable(trial)
        _replace(found, wrong[chosen], trial, chosen, view)
    _disbelieve(found, _improbable(found))
    return found


def excess_noise(cameras: Cameras, covariance: np.ndarray, image: np.ndarray, std: np.ndarray) -> float:
    """How many times as noisy as `std` the readings are, judged by how well the rays of most points meet; at least 1."""
    found = _solve(cameras, covariance, image, std)
    known = found.freedom > 0
    relative = found.square[known] / chi2.median(found.freedom[known])
    return max(1.0, float(np.sqrt(np.median(relative)))) if known.any() else 1.0


def _improbable(found: Triangulation) -> np.ndarray:
    """Which points' views contradict each other, (point,)."""
    believed = np.isfinite(found.position).all(axis=1)
    return believed & (chi2.sf(np.where(believed, found.square, 0.0), np.maximum(found.freedom, 1)) < IMPROBABLE)


def _hidden(image: np.ndarray, view: int) -> np.ndarray:
    without = image.copy()
    without[view] = np.nan
    return without


def _replace(found: Triangulation, places: np.ndarray, trial: Triangulation, chosen: np.ndarray, view: int) -> None:
    """Take some points from a trial that leaves one view out."""
    found.position[places], found.noise[places] = trial.position[chosen], trial.noise[chosen]
    found.response[places], found.square[places] = trial.response[chosen], trial.square[chosen]
    found.used[:, places] = trial.used[:, chosen]
    found.rejected[view, places] = True


def _disbelieve(found: Triangulation, points: np.ndarray) -> None:
    found.rejected[:, points] |= found.used[:, points]
    found.used[:, points] = False
    for array in (found.position, found.noise, found.response):
        array[points] = np.nan


def _solve(cameras: Cameras, covariance: np.ndarray, image: np.ndarray, std: np.ndarray) -> Triangulation:
    """The points without a judgement on their readings."""
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    seen = np.isfinite(image).all(axis=2)
    start = solve_points(coefficients_of(cameras), image)
    enough = np.flatnonzero(np.isfinite(start).all(axis=1))
    count = image.shape[1]
    position, noise = np.full((count, 3), np.nan), np.full((count, 3, 3), np.nan)
    response, square = np.full((count, 3, len(root)), np.nan), np.full(count, np.nan)
    for some in (enough[first : first + CHUNK] for first in range(0, len(enough), CHUNK)):
        position[some], noise[some], response[some], square[some] = _solve_some(
            cameras, root, image[:, some], std[:, some], start[some]
        )
    used = seen & np.isfinite(position).all(axis=1)
    return Triangulation(position, noise, response, square, used, np.zeros_like(used))


def _solve_some(
    cameras: Cameras, root: np.ndarray, image: np.ndarray, std: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Position, noise, response and square of points that two views or more saw; arrays (point, 2 views, ...) of readings."""
    seen = np.isfinite(image).all(axis=2)[..., None]
    by_calibration = _by_point(np.where(seen[..., None], _camera_response(cameras, start, root), 0.0))
    variance = _by_point(np.where(seen, std[..., None] ** 2, np.ones_like(image))[..., None])
    covariance = by_calibration @ by_calibration.transpose(0, 2, 1) + variance * np.eye(variance.shape[1])
    information = np.linalg.inv(covariance)

    def linearised(position: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """How the points follow the readings (point, 3, 2 views), Gauss and Newton's step, and the sum of squares."""
        predicted, derivatives = project_with_point_derivatives(cameras, position)
        residual = _by_point(np.where(seen, image - predicted, 0.0)[..., None])
        slope = _by_point(np.where(seen[..., None], derivatives, 0.0))
        weighted = slope.transpose(0, 2, 1) @ information
        normal = weighted @ slope
        ridge = TINY * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        gain = np.linalg.solve(normal + ridge, weighted)
        square = (residual.transpose(0, 2, 1) @ information @ residual)[:, 0, 0]
        return gain, (gain @ residual)[..., 0], square

    position, share = start, np.ones((len(start), 1))
    gain, step, square = linearised(position)
    for _ in range(STEPS):
        trial = position + share * step
        trial_gain, trial_step, trial_square = linearised(trial)
        better = trial_square <= square
        position, step = np.where(better[:, None], trial, position), np.where(better[:, None], trial_step, step)
        gain, square = np.where(better[:, None, None], trial_gain, gain), np.where(better, trial_square, square)
        share = np.where(better[:, None], 1.0, 0.25 * share)
        if np.abs(share * step).max(initial=0.0) < CLOSE:
            break
    noise = (gain * variance.transpose(0, 2, 1)) @ gain.transpose(0, 2, 1)
    return position, noise, -gain @ by_calibration, square


def _camera_response(cameras: Cameras, points: np.ndarray, root: np.ndarray) -> np.ndarray:
    """How the images move with each standard deviation of the calibration's errors, (view, point, 2, error)."""
    _, _, to_camera = project_with_derivatives(cameras, points)
    return np.asarray(to_camera @ root.reshape(len(cameras), 1, to_camera.shape[-1], -1))


def _by_point(values: np.ndarray) -> np.ndarray:
    """(view, point, 2, n) as (point, 2 views, n)."""
    return np.asarray(values.transpose(1, 0, 2, 3).reshape(values.shape[1], -1, values.shape[3]))
