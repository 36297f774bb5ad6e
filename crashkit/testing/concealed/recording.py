"""A run as the instruments recorded it, in the form of the data contract."""

from typing import Any

import numpy as np
import xarray as xr

from crashkit.testing.concealed.instruments import Instrument, Sensor, read
from crashkit.testing.concealed.world import Motion

_QUANTITY = {
    "film": ("position", "marker", "m"),
    "accelerometer": ("acceleration", "sensor", "m s-2"),
    "load_cell": ("force", "sensor", "N"),
}


def record(
    instruments: dict[str, Instrument], motion: Motion, duration: float, bodies: list[str], rng: np.random.Generator
) -> xr.DataTree:
    """One run as a recording.

    Arguments:
        instruments: by the name of their group.
        motion: what happened.
        duration: s.
        bodies: those that the given model knows to move.
        rng: of the noise and of hidden frames.
    """
    speed = float(motion.velocity[bodies[0]][0])
    groups = {"initial": _initial(motion, bodies)}
    groups |= {name: _group(one, motion, duration, rng) for name, one in instruments.items() if one.sensors}
    tree = xr.DataTree.from_dict(groups)
    tree.attrs = {"crashkit_schema": "recording/1", "title": f"run at {speed:g} m/s"}
    return tree


def _initial(motion: Motion, bodies: list[str]) -> xr.Dataset:
    variables = {
        "position": (("body", "axis"), [[motion.position[body][0]] for body in bodies], {"units": "m"}),
        "velocity": (("body", "axis"), [[motion.velocity[body][0]] for body in bodies], {"units": "m s-1"}),
    }
    return xr.Dataset(variables, coords={"body": bodies, "axis": ["x"]})


def _group(instrument: Instrument, motion: Motion, duration: float, rng: np.random.Generator) -> xr.Dataset:
    quantity, channel, units = _QUANTITY[instrument.observer]
    times, sensors = instrument.times(duration), list(instrument.sensors.values())
    columns = [read(instrument, sensor, motion, duration, rng) for sensor in sensors]
    values = np.where(np.stack([_hidden(sensor, times, rng) for sensor in sensors], 1), np.nan, np.stack(columns, 1))
    variables: dict[str, tuple[Any, ...]] = {
        quantity: (("time", channel, "axis"), values[:, :, None], {"units": units}),
        f"{channel}_body": ((channel,), [sensor.body for sensor in sensors]),
    }
    if instrument.observer != "load_cell":
        variables[f"{channel}_point"] = ((channel, "axis"), np.zeros((len(sensors), 1)), {"units": "m"})
    if instrument.std_given:
        variables[f"{quantity}_std"] = ((channel,), [instrument.recorded_std(sensor) for sensor in sensors], {"units": units})
    coords = {"time": ("time", times, {"units": "s"}), channel: list(instrument.sensors), "axis": ["x"]}
    return xr.Dataset(variables, coords=coords, attrs=_attributes(instrument))


def _attributes(instrument: Instrument) -> dict[str, object]:
    attributes: dict[str, object] = {"observer": instrument.observer}
    if instrument.observer != "film":
        attributes["channel_frequency_class"] = instrument.cfc
    if instrument.observer == "accelerometer":
        attributes["frame"] = "laboratory"
    return attributes


def _hidden(sensor: Sensor, times: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return (rng.random(len(times)) < sensor.hidden) | ((times >= sensor.block[0]) & (times <= sensor.block[1]))
