"""Motions with known derivatives, and sensors to watch them."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr

from crashkit_accelerometers import accelerometers, tumbling


@pytest.fixture
def turning() -> Callable[..., xr.Dataset]:
    """A car in space."""
    return tumbling


@pytest.fixture
def plane() -> Callable[..., xr.Dataset]:
    """The same in the plane x, y."""
    return lambda times, yaw=0.5, **sizes: tumbling(times, yaw, 0.0, 0.0, **sizes)


@pytest.fixture
def sensors() -> Callable[..., xr.Dataset]:
    """Sensors s0, s1, ... on the car, by their points."""

    def sensors(points: list[list[float]], times: np.ndarray, axes: str = "xyz", cfc: int = 0, **more: object) -> xr.Dataset:
        named = {f"s{index}": point for index, point in enumerate(points)}
        return accelerometers(named, times, "car", axes, channel_frequency_class=cfc, **more)

    return sensors


@pytest.fixture
def three() -> list[list[float]]:
    """Points of three sensors that are not in line, about 0.2 m from each other."""
    return [[0.3, 0.05, 0.0], [0.0, 0.22, 0.1], [0.0, -0.12, 0.0]]
