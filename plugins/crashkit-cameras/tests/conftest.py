"""Motions with known answers: in a line, in a plane, in space."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

DIMS = ("time", "body", "axis")
AXIS = np.array([0.3, 0.5, 0.8]) / np.linalg.norm([0.3, 0.5, 0.8])


def _turning(times: np.ndarray, across: float, normal: np.ndarray) -> xr.Dataset:
    """A barrier at rest, and a car that is braked and turns about `normal` by 0.4 sin(15 t)."""
    zero, one = np.zeros((len(times), 3)), np.ones_like(times)
    position = np.stack([-0.6 + 10 * times - 60 * times**2, 0.1 * np.sin(20 * times), across * times], axis=1)
    velocity = np.stack([10 - 120 * times, 2 * np.cos(20 * times), across * one], axis=1)
    turn = Rotation.from_rotvec(0.4 * np.sin(15 * times)[:, None] * normal).as_quat(scalar_first=True)
    spin = 6.0 * np.cos(15 * times)[:, None] * normal
    rest = np.tile([1.0, 0.0, 0.0, 0.0], (len(times), 1))
    return xr.Dataset(
        {
            "position": (DIMS, np.stack([zero, position], axis=1)),
            "velocity": (DIMS, np.stack([zero, velocity], axis=1)),
            "orientation": (("time", "body", "quaternion"), np.stack([rest, turn], axis=1)),
            "angular_velocity": (DIMS, np.stack([zero, spin], axis=1)),
        },
        {"time": times, "body": ["barrier", "car"], "axis": list("xyz")},
    )


def _space(times: np.ndarray) -> xr.Dataset:
    return _turning(times, 0.5, AXIS)


def _plane(times: np.ndarray) -> xr.Dataset:
    return _turning(times, 0.0, np.array([0.0, 0.0, 1.0]))


def _line(times: np.ndarray) -> xr.Dataset:
    return _turning(times, 0.0, AXIS)[["position", "velocity"]].sel(axis=["x"])


@pytest.fixture
def space() -> Callable[[np.ndarray], xr.Dataset]:
    return _space


@pytest.fixture
def plane() -> Callable[[np.ndarray], xr.Dataset]:
    return _plane


@pytest.fixture
def line() -> Callable[[np.ndarray], xr.Dataset]:
    return _line


@pytest.fixture(params=[_line, _plane, _space], ids=["line", "plane", "space"])
def any_motion(request: pytest.FixtureRequest) -> Callable[[np.ndarray], xr.Dataset]:
    motion: Callable[[np.ndarray], xr.Dataset] = request.param
    return motion
