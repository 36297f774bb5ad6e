"""What a smoother returns: a Dataset of values, derivatives and their standard deviations."""

import numpy as np
import xarray as xr

from crashkit_smoothers.reading import Reading

NAMES = ("value", "first_derivative", "second_derivative")
FAMILIAR = {"m": ("m", "m s-1", "m s-2"), "m s-1": ("m s-1", "m s-2", "m s-3"), "m s-2": ("m s-2", "m s-3", "m s-4")}


def curve(reading: Reading, values: np.ndarray, spreads: np.ndarray, attrs: dict[str, object]) -> xr.Dataset:
    """The Dataset over all the reading's instants.

    Arguments:
        values, spreads: (order, time), of the derivatives by x; overwritten.
        attrs: what was chosen and why.
    """
    for order in (1, 2):
        values[order] /= reading.duration**order
        spreads[order] /= reading.duration**order
    variables = {}
    for order, name in enumerate(NAMES):
        units = {"units": _units(reading.units, order)} if reading.units else {}
        for label, numbers in ((name, values), (f"{name}_std", spreads)):
            variables[label] = xr.Variable("time", numbers[order], units)
    return xr.Dataset(variables, {"time": reading.time}, attrs)


def _units(units: str, order: int) -> str:
    if units in FAMILIAR:
        return FAMILIAR[units][order]
    return f"{units} s-{order}" if order else units
