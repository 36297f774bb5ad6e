import os
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crashkit.data.schema import Attribute, GroupSchema, Variable
from crashkit.data.schemas import CHANNEL_FREQUENCY_CLASS, FRAME, body_of, point_of, std_of

FILM = GroupSchema(
    "film",
    (
        Variable("position", ("time", "marker", "axis"), "m", "place of a marker", allow_nan=True),
        body_of("marker"),
        point_of("marker"),
        std_of("position", "marker", "m"),
        Variable("hidden", ("time", "marker"), None, "whether a marker is hidden", kind="flag", required=False),
    ),
)
ACCELEROMETER = GroupSchema(
    "accelerometer",
    (
        Variable("acceleration", ("time", "sensor", "axis"), "m s-2", "of a sensor"),
        body_of("sensor"),
        point_of("sensor"),
        std_of("acceleration", "sensor", "m s-2"),
    ),
    (CHANNEL_FREQUENCY_CLASS, FRAME, Attribute("maker", "who made it", required=False)),
)


@pytest.fixture(scope="session")
def schemas() -> dict[str, GroupSchema]:
    return {"film": FILM, "accelerometer": ACCELEROMETER}


@pytest.fixture
def film() -> xr.Dataset:
    return xr.Dataset(
        {
            "position": (("time", "marker", "axis"), np.arange(8.0).reshape(4, 2, 1), {"units": "m"}),
            "marker_body": ("marker", ["engine", "body"]),
            "marker_point": (("marker", "axis"), np.zeros((2, 1)), {"units": "m"}),
            "position_std": ("marker", [0.001, 0.001], {"units": "m"}),
        },
        {"time": ("time", [0.0, 0.001, 0.002, 0.004], {"units": "s"}), "marker": ["m1", "m2"], "axis": ["x"]},
        {"observer": "film"},
    )


@pytest.fixture
def accelerometer() -> xr.Dataset:
    return xr.Dataset(
        {
            "acceleration": (("time", "sensor", "axis"), np.ones((3, 1, 1)), {"units": "m s-2"}),
            "sensor_body": ("sensor", ["engine"]),
            "sensor_point": (("sensor", "axis"), np.zeros((1, 1)), {"units": "m"}),
        },
        {"time": ("time", [0.0, 1e-4, 2e-4], {"units": "s"}), "sensor": ["engine_acc"], "axis": ["x"]},
        {"observer": "accelerometer", "channel_frequency_class": 60, "frame": "laboratory"},
    )


@pytest.fixture
def initial() -> xr.Dataset:
    return xr.Dataset(
        {
            "position": (("body", "axis"), [[-0.7], [-1.6]], {"units": "m"}),
            "velocity": (("body", "axis"), [[12.0], [12.0]], {"units": "m s-1"}),
        },
        {"body": ["engine", "body"], "axis": ["x"]},
    )


@pytest.fixture
def recording(film: xr.Dataset, accelerometer: xr.Dataset, initial: xr.Dataset) -> xr.DataTree:
    root = xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": "run at 12 m/s"})
    return xr.DataTree.from_dict({"/": root, "initial": initial, "film": film, "accelerometer": accelerometer})


@pytest.fixture(scope="session")
def cases() -> Path:
    folder = Path(os.environ.get("CRASHKIT_CASES", Path(__file__).parents[3] / "shared" / "cases"))
    if not folder.is_dir() and not os.environ.get("CI"):
        pytest.skip(f"no sample cases in {folder}; CRASHKIT_CASES names another folder")
    return folder
