"""Accelerometer groups before anything was recorded: to plan a test, or to simulate one."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit_accelerometers.error_specs import AXES


def accelerometers(
    points: Mapping[str, Sequence[float]],
    times: np.ndarray,
    body: str,
    axes: Sequence[str] = AXES,
    std: float = 1.0,
    channel_frequency_class: int = 0,
    frame: str = "body",
) -> xr.Dataset:
    """Sensors on a body, with readings yet to be made (NaN).

    Arguments:
        points: of each sensor by its name, along `axes`, from the body's centre of mass, m.
        times: of the samples, s.
        body: its name.
        axes: that each sensor records.
        std: of a sample as recorded, m s-2.
        channel_frequency_class: SAE J211; 0 for unfiltered.
        frame: "body" if the sensors' axes turn with the body, else "laboratory".
    """
    shape = (len(times), len(points), len(axes))
    return xr.Dataset(
        {
            "acceleration": (("time", "sensor", "axis"), np.full(shape, np.nan), {"units": "m s-2"}),
            "sensor_body": ("sensor", [body] * len(points)),
            "sensor_point": (("sensor", "axis"), np.array(list(points.values()), dtype=float), {"units": "m"}),
            "acceleration_std": ("sensor", np.full(len(points), std), {"units": "m s-2"}),
        },
        {"time": ("time", times, {"units": "s"}), "sensor": list(points), "axis": list(axes)},
        {"observer": "accelerometer", "channel_frequency_class": channel_frequency_class, "frame": frame},
    )
