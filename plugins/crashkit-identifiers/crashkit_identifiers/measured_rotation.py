"""How a body turned, from the orientations that an instrument saw."""

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from crashkit.model import Body
from crashkit_identifiers.spline import Reading, enough, smoothed

Sightings = Sequence[tuple[np.ndarray, np.ndarray]]
"""Times and unit quaternions (w, x, y, z) of each instrument."""


def rotation_curves(sightings: Sightings, times: np.ndarray, body: Body, axes: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Orientation, angular velocity and angular acceleration, with the standard deviation of the last; NaN where unseen.

    With R = exp([φ]) R_0, a spline for each component of φ, and eq 28 of Mizzi & Jezequel 1992 solved for the rate:

    ω = φ' + (1 - cos φ)/φ² φ × φ' + (φ - sin φ)/φ³ φ × (φ × φ').
    """
    count = len(times)
    if body.fixed:
        still = np.zeros((count, 3))
        return _named(np.tile(_first(body, axes).as_quat(scalar_first=True), (count, 1)), still, still, still)
    turns = [(stamps, Rotation.from_quat(quaternions, scalar_first=True)) for stamps, quaternions in sightings if len(stamps)]
    if not turns:
        nothing = np.full((count, 3), np.nan)
        return _named(np.full((count, 4), np.nan), nothing, nothing, nothing)
    origin = turns[0][1][0]
    readings = [
        [Reading(0, stamps, (turn * origin.inv()).as_rotvec()[:, axis], 1.0) for stamps, turn in turns] for axis in range(3)
    ]
    if not all(enough(own) for own in readings):
        return rotation_curves([], times, body, axes)
    curves = [smoothed(own, times) for own in readings]
    phi, rate = (np.column_stack([curve[order][0] for curve in curves]) for order in (0, 1))
    spin = _spin(phi, rate)
    inside = np.isfinite(spin).all(axis=1)
    change = np.full((count, 3), np.nan)
    change[inside] = CubicSpline(times[inside], spin[inside])(times[inside], 1)
    orientation = np.full((count, 4), np.nan)
    orientation[inside] = (Rotation.from_rotvec(phi[inside]) * origin).as_quat(scalar_first=True)
    return _named(orientation, spin, change, np.column_stack([curve[2][1] for curve in curves]))


def _named(orientation: np.ndarray, spin: np.ndarray, change: np.ndarray, std: np.ndarray) -> dict[str, np.ndarray]:
    return {
        "orientation": orientation,
        "angular_velocity": spin,
        "angular_acceleration": change,
        "angular_acceleration_std": std,
    }


def _spin(phi: np.ndarray, rate: np.ndarray) -> np.ndarray:
    angle = np.maximum(np.linalg.norm(phi, axis=1, keepdims=True), 1e-6)  # below, the series' first terms are exact
    across = np.cross(phi, rate)
    return rate + (1.0 - np.cos(angle)) / angle**2 * across + (angle - np.sin(angle)) / angle**3 * np.cross(phi, across)


def _first(body: Body, axes: tuple[str, ...]) -> Rotation:
    """The orientation at t = 0 as the model gives it."""
    if len(body.orientation) == 4:
        return Rotation.from_quat(body.orientation, scalar_first=True)
    if len(body.orientation) == 1:
        first, second = (np.eye(3)["xyz".index(axis)] for axis in axes)
        return Rotation.from_rotvec(body.orientation[0] * np.cross(first, second))
    return Rotation.identity()
