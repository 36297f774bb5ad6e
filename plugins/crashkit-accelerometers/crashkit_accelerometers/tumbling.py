"""A motion in closed form, to try sensors on: a car that is braked, and yaws, pitches and rolls."""

import numpy as np
import xarray as xr
from numpy import cos, pi, sin
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

DIMS = ("time", "body", "axis")
SPEED = 15.0
"""m s-1, along x"""


def tumbling(times: np.ndarray, yaw: float = 0.5, pitch: float = 0.2, roll: float = 0.7, brake: float = 1.0) -> xr.Dataset:
    """The exact motion of the body "car".

    Each angle and each displacement is size (1 - cos w t)^2 / 2, which starts smoothly from rest.

    Arguments:
        times: s.
        yaw, pitch, roll: sizes, rad, at 6, 9 and 4 Hz; the largest angle is twice that. Yaw alone is a motion in the plane.
        brake: size of the displacement against the speed of 15 m/s, in units of 0.4 m at 5 Hz.

    Returns:
        A motion with all that bodies in space have.
    """
    (a, a1, a2), (b, b1, b2), (c, c1, c2) = _wave(yaw, 6.0, times), _wave(pitch, 9.0, times), _wave(roll, 4.0, times)
    rotation = Rotation.from_euler("ZYX", np.stack([a, b, c], axis=1))
    rates = [c1 - a1 * sin(b), b1 * cos(c) + a1 * cos(b) * sin(c), a1 * cos(b) * cos(c) - b1 * sin(c)]
    changes = [
        c2 - a2 * sin(b) - a1 * b1 * cos(b),
        b2 * cos(c) - b1 * c1 * sin(c) + a2 * cos(b) * sin(c) - a1 * b1 * sin(b) * sin(c) + a1 * c1 * cos(b) * cos(c),
        a2 * cos(b) * cos(c) - a1 * b1 * sin(b) * cos(c) - a1 * c1 * cos(b) * sin(c) - b2 * sin(c) - b1 * c1 * cos(c),
    ]
    along, across, up = _wave(-0.4 * brake, 5.0, times), _wave(0.05, 11.0, times), _wave(0.1 * pitch, 7.0, times)
    return _motion(
        times,
        rotation,
        position=([along[0] + SPEED * times, across[0], up[0]], "m"),
        velocity=([along[1] + SPEED, across[1], up[1]], "m s-1"),
        acceleration=([along[2], across[2], up[2]], "m s-2"),
        angular_velocity=(rotation.apply(np.stack(rates, axis=1)).T, "rad s-1"),
        angular_acceleration=(rotation.apply(np.stack(changes, axis=1)).T, "rad s-2"),
    )


def _wave(size: float, frequency: float, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """With its derivatives."""
    w, c, s = 2 * pi * frequency, cos(2 * pi * frequency * times), sin(2 * pi * frequency * times)
    return size * (1 - c) ** 2 / 2, size * w * (1 - c) * s, size * w**2 * (s**2 + c - c**2)


def _motion(times: np.ndarray, rotation: Rotation, **columns: tuple[ArrayLike, str]) -> xr.Dataset:
    variables = {
        name: xr.Variable(DIMS, np.asarray(values).T[:, None], {"units": units}) for name, (values, units) in columns.items()
    }
    quaternion = rotation.as_quat(scalar_first=True)[:, None]
    variables["orientation"] = xr.Variable(("time", "body", "quaternion"), quaternion, {"units": "1"})
    return xr.Dataset(variables, {"time": ("time", times, {"units": "s"}), "body": ["car"], "axis": ["x", "y", "z"]})
