"""Position and orientation of a rigid body from the positions of its markers."""

from collections.abc import Sequence

import numpy as np
from attrs import frozen

from crashkit_cameras.projection import cross_matrix, rotation_matrix

AXES = ("x", "y", "z")
STEPS = 4
FLAT = 0.01
"""Extent of markers over that of the longest side, below which they count as lying in one point or on one line."""


@frozen(eq=False)
class Pose:
    """Where a body is.

    Attributes:
        position: of its centre of mass, (time, axis), m; NaN where too few markers are visible.
        rotation: body frame to laboratory frame, (time, 3, 3).
        turns: the axes about which its turning is known, (3, turn); none: it is taken not to turn.
        covariance: of position and rotation about these axes, (time, axis + turn, axis + turn).
    """

    position: np.ndarray
    rotation: np.ndarray
    turns: np.ndarray
    covariance: np.ndarray


def fit_pose(
    points: np.ndarray, positions: np.ndarray, information: np.ndarray, response: np.ndarray, axes: Sequence[str]
) -> Pose:
    """The most probable pose of a body at each time.

    Minimises Σ e' W e over its visible markers, e = X - x - R p: Kabsch's rotation (Acta Cryst. A32, 1976, 922-923), then
    Gauss and Newton's steps, because X may be known better along one axis than another. In space it takes three markers
    that are not on one line, in a plane two; with fewer, the body is taken not to turn.

    Arguments:
        points: of the markers in the body's frame, (marker, axis), m.
        positions: of the markers, (time, marker, axis), m, NaN where hidden.
        information: inverse of their covariance, (time, marker, axis, axis), from errors of each marker's own.
        response: to errors of standard deviation 1 that all markers share, (time, marker, axis, error), m.
        axes: of the laboratory frame, one to three.
    """
    visible = np.isfinite(positions).all(axis=2)
    turns = _turns(axes)
    enough = visible.any(axis=1) & (_spread(points, visible) >= len(axes) - 1)
    if not enough.any():
        turns, enough = turns[:, :0], visible.any(axis=1)
    visible = visible & enough[:, None]
    weight = np.where(visible[..., None, None], information, 0.0)
    seen = np.where(visible[..., None], positions, 0.0)
    place = np.eye(3)[[AXES.index(axis) for axis in axes]]
    rotation = _kabsch(points, seen, weight, place, turns) if turns.size else np.tile(np.eye(3), (len(seen), 1, 1))
    position = np.zeros((len(seen), len(axes)))
    for _ in range(STEPS):
        arm = (rotation[:, None] @ (points @ place)[..., None])[..., 0]
        slope = _slope(arm, place, turns)
        weighted = slope.swapaxes(2, 3) @ weight
        normal = (weighted @ slope).sum(axis=1) + ~enough[:, None, None] * np.eye(slope.shape[3])
        error = seen - position[:, None] - arm @ place.T
        covariance = np.linalg.inv(normal)
        step = (covariance @ (weighted @ error[..., None]).sum(axis=1))[..., 0]
        position = position + step[:, : len(axes)]
        rotation = rotation_matrix(step[:, len(axes) :] @ turns.T) @ rotation
    shared = covariance @ (weighted @ np.where(visible[..., None, None], response, 0.0)).sum(axis=1)
    covariance = covariance + shared @ shared.swapaxes(1, 2)
    for array in (position, rotation, covariance):
        array[~enough] = np.nan
    return Pose(position, rotation, turns, covariance)


def _turns(axes: Sequence[str]) -> np.ndarray:
    """The axes about which a body can turn in a line, a plane or space, as columns, (3, 0 or 1 or 3)."""
    if len(axes) == len(AXES):
        return np.eye(3)
    normals = [index for index, axis in enumerate(AXES) if axis not in axes]
    return np.eye(3)[:, normals] if len(normals) == 1 else np.zeros((3, 0))


def _spread(points: np.ndarray, visible: np.ndarray) -> np.ndarray:
    """In how many directions the visible markers of each time extend, (time,)."""
    count = np.maximum(visible.sum(axis=1), 1)
    mean = (visible @ points) / count[:, None]
    centred = np.where(visible[..., None], points - mean[:, None], 0.0)
    extents = np.sqrt(np.abs(np.linalg.eigvalsh(centred.swapaxes(1, 2) @ centred)))
    return np.asarray((extents > np.maximum(FLAT * extents[:, -1:], 1e-9)).sum(axis=1))


def _kabsch(points: np.ndarray, seen: np.ndarray, weight: np.ndarray, place: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """The rotation that fits best if all axes were known alike, (time, 3, 3)."""
    share = np.trace(weight, axis1=2, axis2=3)[..., None]
    total = np.maximum(share.sum(axis=1, keepdims=True), 1e-300)
    share = share / total
    mean, centre = (share * seen).sum(axis=1, keepdims=True), (share * points).sum(axis=1, keepdims=True)
    moment = (share * (seen - mean)).swapaxes(1, 2) @ (points - centre)
    left, _, right = np.linalg.svd(moment)
    left[..., -1] *= np.linalg.det(left @ right)[:, None]
    rest = turns @ turns.T if len(place) == 2 else np.zeros((3, 3))
    return np.asarray(place.T @ (left @ right) @ place + rest)


def _slope(arm: np.ndarray, place: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """d(x + R p) / d(x, turn), (time, marker, axis, axis + turn)."""
    still = np.broadcast_to(np.eye(len(place)), (*arm.shape[:2], len(place), len(place)))
    return np.concatenate([still, -(place @ cross_matrix(arm) @ turns)], axis=3)
