"""Cameras and points together, from all their images: the most probable, and how far both may be off."""

import numpy as np
from attrs import frozen

from crashkit_cameras.prior import Expectation
from crashkit_cameras.projection import PARAMETERS, Cameras, depths, project, project_with_derivatives

TAIL = 8.0
"""Degrees of freedom of Student's distribution of a reading's error: normal, but for blunders."""
STEPS = 100
FIRST_DAMPING, LEAST_DAMPING, HOPELESS = 1e-3, 1e-9, 1e12
"""Shares of the diagonal that are added to it; at the last no step is left to speak of."""
FIXED = 1e30
"""Information on a number that is not to move."""
TINY = 1e-14
"""Of the information on a point, added so that a point at infinity does no harm."""
ENOUGH = 1e-6
"""A gain in the logarithm of the density that is not worth another step."""


@frozen(eq=False)
class Readings:
    """Images of points.

    Attributes:
        image: (view, point, 2), pixel, NaN where a point is hidden.
        std: (view, point), pixel.
        known: (point, 3), m, the points' surveyed places (any number where nothing is known).
        known_std: (point,), m: 0 for a point whose place is exact, infinite for a marker.
    """

    image: np.ndarray
    std: np.ndarray
    known: np.ndarray
    known_std: np.ndarray

    @property
    def seen(self) -> np.ndarray:
        """Which readings there are, (view, point)."""
        return np.isfinite(self.image).all(axis=2)

    def residuals(self, cameras: Cameras, points: np.ndarray) -> np.ndarray:
        """(recorded - predicted) / std, (view, point, 2), 0 where hidden."""
        residual = (self.image - project(cameras, points)) / self.std[..., None]
        return np.where(self.seen[..., None], residual, 0.0)


@frozen(eq=False)
class Estimate:
    """Where cameras and points most probably are.

    Attributes:
        cameras, points: (point, 3).
        cost: the negative logarithm of the posterior density, but for a constant.
        covariance: of the cameras' steps, (16 view, 16 view).
        log_mass: the logarithm of the posterior's mass about this place (Laplace's approximation), but for the same
            constant: by it, places that both are most probable among their neighbours are compared.
    """

    cameras: Cameras
    points: np.ndarray
    cost: float
    covariance: np.ndarray
    log_mass: float


def robust_weight(square: np.ndarray) -> np.ndarray:
    """The weight of a reading whose squared residual, in standard deviations, is `square`: near 1, small for blunders."""
    return np.asarray((TAIL + 2.0) / (TAIL + square))


def adjust(cameras: Cameras, points: np.ndarray, readings: Readings, expectation: Expectation) -> Estimate:
    """The most probable cameras and points, by Levenberg and Marquardt's method; the points are eliminated from each step.

    Minimises (nu + 2)/2 Σ log(1 + |e|²/nu) + Σ |X - X_known|² / 2 σ_known² + the prior's cost,
    e the residuals in standard deviations, and nu their TAIL.

    Arguments:
        cameras, points: to start from.
        readings: at least the control points'.
        expectation: of the cameras.
    """
    cameras, points, cost = _descended(cameras, points, readings, expectation)
    if not np.isfinite(cost):
        return Estimate(cameras, points, np.inf, np.full((PARAMETERS * len(cameras),) * 2, np.inf), -np.inf)
    covariance = normal_equations(cameras, points, readings, expectation).covariance()
    free = ~expectation.held().ravel()
    volume = 0.5 * np.linalg.slogdet(2.0 * np.pi * covariance[np.ix_(free, free)])[1]
    return Estimate(cameras, points, cost, covariance, float(volume - cost))


@frozen(eq=False)
class NormalEquations:
    """The equations of one step, all in standard deviations.

    Attributes:
        to_camera: derivatives of the readings, (view, point, 2, 16).
        to_point: (view, point, 2, 3).
        camera: information on the cameras, (16 view, 16 view), and its right-hand side.
        point: inverse of the information on each point, (point, 3, 3): 0 where the point is exact.
        cross: between the cameras and each point, (point, 16 view, 3).
    """

    to_camera: np.ndarray
    to_point: np.ndarray
    camera: np.ndarray
    camera_right: np.ndarray
    point: np.ndarray
    point_right: np.ndarray
    cross: np.ndarray

    def step(self, damping: float) -> tuple[np.ndarray, np.ndarray]:
        """Steps of the cameras (view, 16) and of the points (point, 3)."""
        reduced = self._reduced() + damping * np.diag(np.diag(self.camera))
        right = self.camera_right - (self.cross @ (self.point @ self.point_right[..., None])).sum(axis=0)[:, 0]
        step = np.linalg.solve(reduced, right)
        shift = self.point @ (self.point_right - step @ self.cross)[..., None]
        return step.reshape(-1, PARAMETERS), shift[..., 0]

    def covariance(self) -> np.ndarray:
        """Of the cameras' steps; what nothing determines has a very large variance."""
        reduced = self._reduced()
        scale = 1.0 / np.sqrt(np.diag(reduced))
        values, vectors = np.linalg.eigh(scale[:, None] * reduced * scale)
        root = scale[:, None] * vectors / np.sqrt(np.maximum(values, 1e-14))
        return np.asarray(root @ root.T)

    def redundancy(self) -> np.ndarray:
        """How many of the two coordinates of each reading are left to judge its noise by, (view, point).

        2 - trace of the covariance of the fitted reading, in variances of the reading.
        """
        covariance = self.covariance()
        gain = self.cross @ self.point
        left = np.full(self.to_point.shape[:2], 2.0)
        for view, (to_camera, to_point) in enumerate(zip(self.to_camera, self.to_point, strict=True)):
            response = -(to_point @ gain.transpose(0, 2, 1))
            response[..., PARAMETERS * view : PARAMETERS * (view + 1)] += to_camera
            left[view] -= ((response @ covariance) * response).sum(axis=(1, 2))
            left[view] -= ((to_point @ self.point) * to_point).sum(axis=(1, 2))
        return left

    def _reduced(self) -> np.ndarray:
        """The information on the cameras once the points follow them."""
        gain = (self.cross @ self.point).transpose(1, 0, 2).reshape(len(self.camera), -1)
        return np.asarray(self.camera - gain @ self.cross.transpose(1, 0, 2).reshape(len(self.camera), -1).T)


def normal_equations(cameras: Cameras, points: np.ndarray, readings: Readings, expectation: Expectation) -> NormalEquations:
    """The equations of a step from these cameras and points."""
    residual = readings.residuals(cameras, points)
    weight = np.where(readings.seen, np.sqrt(robust_weight((residual**2).sum(axis=2))), 0.0)
    _, to_point, to_camera = project_with_derivatives(cameras, points)
    to_camera *= ~expectation.held()[:, None, None, :]
    scale = (weight / readings.std)[..., None, None]
    to_camera, to_point, residual = to_camera * scale, to_point * scale, residual * weight[..., None]
    camera, camera_right = _camera_equations(cameras, to_camera, residual, expectation)
    inverse, point_right = _point_equations(points, to_point, residual, readings)
    cross = to_camera.transpose(1, 0, 3, 2) @ to_point.transpose(1, 0, 2, 3)
    cross = cross.reshape(len(points), len(camera), 3)
    return NormalEquations(to_camera, to_point, camera, camera_right, inverse, point_right, cross)


def _descended(
    cameras: Cameras, points: np.ndarray, readings: Readings, expectation: Expectation
) -> tuple[Cameras, np.ndarray, float]:
    """Where the cost has its nearest minimum, and its value there."""
    cost, damping = posterior_cost(cameras, points, readings, expectation), FIRST_DAMPING
    for _ in range(STEPS if np.isfinite(cost) else 0):
        equations = normal_equations(cameras, points, readings, expectation)
        before = cost
        while damping < HOPELESS:
            step, shift = equations.step(damping)
            trial = cameras.moved(step), points + shift
            cost = posterior_cost(*trial, readings, expectation)
            if cost <= before:
                cameras, points = trial
                break
            cost, damping = before, 8.0 * damping
        damping = max(0.1 * damping, LEAST_DAMPING)
        if before - cost < ENOUGH:
            break
    return cameras, points, cost


def _camera_equations(
    cameras: Cameras, to_camera: np.ndarray, residual: np.ndarray, expectation: Expectation
) -> tuple[np.ndarray, np.ndarray]:
    flat = to_camera.reshape(len(cameras), -1, PARAMETERS)
    blocks = flat.transpose(0, 2, 1) @ flat
    right = (flat.transpose(0, 2, 1) @ residual.reshape(len(cameras), -1, 1))[..., 0]
    weight = expectation.weight(cameras)
    right -= weight * expectation.difference(cameras)
    diagonal = np.where(expectation.held(), FIXED, weight)
    camera = np.diag(diagonal.ravel())
    for view, block in enumerate(blocks):
        own = slice(PARAMETERS * view, PARAMETERS * (view + 1))
        camera[own, own] += block
    return camera, right.ravel()


def _point_equations(
    points: np.ndarray, to_point: np.ndarray, residual: np.ndarray, readings: Readings
) -> tuple[np.ndarray, np.ndarray]:
    exact = readings.known_std == 0.0
    precision = np.where(exact, 1.0, readings.known_std) ** -2.0
    information = (to_point.transpose(0, 1, 3, 2) @ to_point).sum(axis=0)
    least = TINY * np.trace(information, axis1=1, axis2=2) + 1.0 / FIXED
    information += (precision + least)[:, None, None] * np.eye(3)
    right = (to_point * residual[..., None]).sum(axis=(0, 2)) - precision[:, None] * (points - readings.known)
    inverse = np.linalg.inv(information)
    inverse[exact] = 0.0
    return inverse, right


def posterior_cost(cameras: Cameras, points: np.ndarray, readings: Readings, expectation: Expectation) -> float:
    """What `adjust` minimises; infinite where a point would be behind a camera."""
    if not (depths(cameras, points)[readings.seen] > 0.0).all():
        return np.inf
    square = (readings.residuals(cameras, points) ** 2).sum(axis=2)
    surveyed = (readings.known_std > 0.0) & np.isfinite(readings.known_std)
    shift = (points - readings.known)[surveyed] / readings.known_std[surveyed, None]
    misfit = 0.5 * (TAIL + 2.0) * np.log1p(square / TAIL).sum() + 0.5 * (shift**2).sum()
    return float(misfit + expectation.cost(cameras))
