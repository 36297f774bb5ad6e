"""The motion, the cameras and the clocks that together explain best what several views saw."""

import numpy as np
from attrs import frozen

from crashkit_cameras.projection import PARAMETERS, Cameras, project_with_derivatives
from crashkit_cameras.synchronise.spline import BRIDGE, basis

OWN = 2 + PARAMETERS
"""Numbers of a view: its clock's offset and rate, and its camera's step (see `Cameras.moved`)."""


@frozen(eq=False)
class Views:
    """What the views recorded, and what is known of them.

    Attributes:
        stamps: (time,), s.
        epoch: s.
        image: (view, time, marker, 2), pixel, NaN where hidden.
        std: of a reading, (marker,), pixel.
        knots: of the spline along which each marker moves.
        cameras: as calibrated.
        information: inverse covariance of the views' own numbers about 0, (18 view, 18 view).
    """

    stamps: np.ndarray
    epoch: float
    image: np.ndarray
    std: np.ndarray
    knots: np.ndarray
    cameras: Cameras
    information: np.ndarray


@frozen(eq=False)
class State:
    """The views' own numbers (view, 18), and the coefficients of each marker's spline (marker, 3, function), m."""

    own: np.ndarray
    splines: np.ndarray

    def towards(self, other: "State", part: float) -> "State":
        """Part of the way to another state."""
        return State(self.own + part * (other.own - self.own), self.splines + part * (other.splines - self.splines))


@frozen(eq=False)
class Linear:
    """The problem about a state.

    Attributes:
        better: the state that solves the linear problem.
        reduced: the normal matrix of the views' own numbers, the splines eliminated, (18 view, 18 view).
        illusion: the part of it about the clocks that comes from the noise of the velocities, (view, 2, 2).
        cost: sum of squares in standard deviations, of the readings and of what was known.
        square: of the readings alone.
        readings: their number, u and v each.
    """

    better: State
    reduced: np.ndarray
    illusion: np.ndarray
    cost: float
    square: float
    readings: int


def linearised(views: Views, state: State) -> Linear:
    """Gauss-Newton's equations of all readings, the splines eliminated marker by marker (Schur's complement)."""
    parts = [_view_equations(views, state, view) for view in range(len(state.own))]
    own = state.own.ravel()
    reduced, right = views.information.copy(), -views.information @ own
    solved, illusion = [], np.zeros((len(parts), 2, 2))
    for view, part in enumerate(parts):
        place = slice(view * OWN, (view + 1) * OWN)
        reduced[place, place] += np.einsum("nmai,nmaj->ij", part.to_own, part.to_own)
        right[place] += np.einsum("nmai,nma->i", part.to_own, part.residual)
    for marker, spline in enumerate(state.splines):
        normal, mixed, gradient = _marker_equations(parts, marker, spline)
        eliminated = np.linalg.solve(normal, np.column_stack([mixed, gradient]))
        reduced -= mixed.T @ eliminated[:, :-1]
        right -= mixed.T @ eliminated[:, -1]
        solved.append(eliminated)
        illusion += [_illusion(part, marker, normal, views.stamps - views.epoch) for part in parts]
    step = np.linalg.solve(reduced, right)
    splines = [
        spline + (one[:, -1] - one[:, :-1] @ step).reshape(spline.shape)
        for spline, one in zip(state.splines, solved, strict=True)
    ]
    square = float(sum(np.sum(part.residual**2) for part in parts))
    better = State((own + step).reshape(state.own.shape), np.array(splines))
    cost = square + float(own @ views.information @ own)
    return Linear(better, reduced, illusion, cost, square, int(np.isfinite(views.image).sum()))


@frozen(eq=False)
class _Equations:
    """A view's residuals (time, marker, 2) in standard deviations, their derivatives, and the splines' functions and rates."""

    residual: np.ndarray
    to_own: np.ndarray
    to_point: np.ndarray
    functions: np.ndarray
    rates: np.ndarray


def _view_equations(views: Views, state: State, view: int) -> _Equations:
    """Derivatives to the view's own numbers (time, marker, 2, 18) and to the markers' places (time, marker, 2, 3)."""
    offset, rate = state.own[view, :2]
    since = views.stamps - views.epoch
    times = views.stamps - offset - rate * since
    functions = basis(views.knots, times)
    points = np.einsum("nk,mck->nmc", functions, state.splines)
    rates = basis(views.knots, times, 1)
    velocity = np.einsum("nk,mck->nmc", rates, state.splines)

    camera = views.cameras.select(slice(view, view + 1)).moved(state.own[view : view + 1, 2:])
    image, to_point, to_camera = (array[0] for array in project_with_derivatives(camera, points.reshape(-1, 3)))
    seen, (count, markers, _) = np.isfinite(views.image[view]).all(axis=-1), points.shape
    weight = np.where(seen, 1.0 / views.std, 0.0)[..., None]
    residual = np.where(seen[..., None], views.image[view] - image.reshape(count, markers, 2), 0.0) * weight
    to_point = to_point.reshape(count, markers, 2, 3) * weight[..., None]
    late = -np.einsum("nmac,nmc->nma", to_point, velocity)[..., None]
    to_camera = to_camera.reshape(count, markers, 2, PARAMETERS) * weight[..., None]
    to_own = np.concatenate([late, late * since[:, None, None, None], to_camera], axis=-1)
    return _Equations(residual, to_own, to_point, functions, rates)


def _marker_equations(parts: list[_Equations], marker: int, spline: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A marker's normal matrix, its mixed part with the views' own numbers, and its gradient."""
    size = spline.size
    normal, mixed, gradient = np.zeros((size, size)), np.zeros((size, OWN * len(parts))), np.zeros(size)
    for view, part in enumerate(parts):
        slopes = (part.to_point[:, marker, :, :, None] * part.functions[:, None, None, :]).reshape(-1, size)
        normal += slopes.T @ slopes
        mixed[:, view * OWN : (view + 1) * OWN] = slopes.T @ part.to_own[:, marker].reshape(-1, OWN)
        gradient += slopes.T @ part.residual[:, marker].ravel()
    second = np.kron(np.eye(3), np.diff(np.eye(spline.shape[1]), 2, axis=0))
    smooth = BRIDGE * np.trace(normal) / size * second.T @ second
    return normal + smooth, mixed, gradient - smooth @ spline.ravel()


def _illusion(part: _Equations, marker: int, normal: np.ndarray, since: np.ndarray) -> np.ndarray:
    """What the noise of a marker's velocity contributes to a clock's normal matrix: a target at rest seems to move."""
    slopes = (part.to_point[:, marker, :, :, None] * part.rates[:, None, None, :]).reshape(-1, len(normal))
    variance = np.sum(slopes * np.linalg.solve(normal, slopes.T).T, axis=1).reshape(-1, 2).sum(axis=1)
    powers = np.stack([np.ones_like(since), since])
    return np.asarray(powers * variance @ powers.T)
