"""Sensors that recorded nothing: left out, and warned of."""

import warnings
from collections.abc import Mapping

import xarray as xr

from crashkit.data.recording import instruments
from crashkit.data.validate import names
from crashkit.protocols import Observer

LEFT_OUT = "left_out"
"""Attribute of a recording: what was left out of it, a line for each instrument."""


def without_silent(run: str, recording: xr.DataTree, observers: Mapping[str, type[Observer]]) -> xr.DataTree:
    """A recording without the sensors of which no reading is a number, as of a marker that was hidden throughout.

    Arguments:
        run: the name that the warning gives.
        recording: as it was checked.
        observers: that are installed, by name.
    """
    for name, kind in instruments(recording).items():
        if kind in observers:
            recording = _heard(run, recording, name, observers[kind])
    return recording


def left_out_of(recording: xr.DataTree) -> list[str]:
    """What was left out of a recording, a sentence for each instrument."""
    return str(recording.attrs.get(LEFT_OUT, "")).splitlines()


def _heard(run: str, recording: xr.DataTree, name: str, observer: type[Observer]) -> xr.DataTree:
    instrument = recording.children[name].to_dataset(inherit=False)
    readings, sensor = instrument[observer.quantity], observer.channel
    is_silent = readings.isnull().all([dim for dim in readings.dims if dim != sensor])
    if not is_silent.any():
        return recording
    silent = names(instrument[sensor].values[is_silent.values].tolist())
    sentence = f"{run}: {name}/{observer.quantity}: only NaN of {silent}; left out"
    warnings.warn(sentence, stacklevel=3)
    heard = recording.assign({name: xr.DataTree(instrument.isel({sensor: ~is_silent.values}))})
    heard.attrs[LEFT_OUT] = "\n".join([*left_out_of(recording), sentence])
    return heard
