"""What an identified model predicts for each instrument, and how far its parameters leave that open."""

from collections.abc import Iterator, Mapping
from contextlib import suppress

import numpy as np
import xarray as xr

from crashkit.errors import SimulationError
from crashkit.misfit.channel import Group
from crashkit.misfit.predictor import Prediction
from crashkit.misfit.problem import Misfit
from crashkit.protocols import Identification

CONFIDENCE = 1.96
"""Standard deviations to either side that hold 95 %."""
OPEN_END = 10.0
"""Factor on its value that a parameter may move where its interval has no end."""


def predicted_curves(fitted: Misfit, shown: Misfit, result: Identification) -> xr.DataTree:
    """What the identified model predicts for every instrument of `shown`, with 95 % bands.

    y ± 1.96 sqrt(diag(S C Sᵀ)), where S are the derivatives of the predictions y to the parameters and C is their covariance.
    A parameter that the fitted recordings do not identify widens the band to what is predicted at the ends of its interval: a
    threshold that they never reached may lie within the reach of a faster test. The noise of the instruments is not in it.

    Arguments:
        fitted: the misfit that was identified.
        shown: of the same model, over these recordings or others.
        result: of the identification.

    Returns:
        by `run/instrument`: Dataset over (time, channel) with `recorded`, `predicted`, `lower`, `upper` in the instrument's
        unit, and `noise` (channel); attributes `quantity`, `units`, and `fitted`, which is 1 where the run was.
    """
    predictions = shown.predictor.predict(result.values, sensitivities=True)
    ends = list(_loose_ends(fitted, shown, result))
    covariance = np.nan_to_num(result.parameters["covariance"].values, nan=0.0, posinf=0.0, neginf=0.0)
    curves = {}
    for number, (group, prediction) in enumerate(zip(shown.groups, predictions, strict=True)):
        elsewhere = [end[number].samples for end in ends]
        is_fitted = group.run in fitted.recordings
        curves[f"{group.run}/{group.name}"] = _curve(group, prediction, covariance, elsewhere, is_fitted)
    return xr.DataTree.from_dict(curves)


def _curve(
    group: Group, prediction: Prediction, covariance: np.ndarray, elsewhere: list[np.ndarray], is_fitted: bool
) -> xr.Dataset:
    slopes = prediction.sensitivity
    assert slopes is not None  # asked for by the only caller
    half = CONFIDENCE * np.sqrt(np.maximum(np.einsum("tci,ij,tcj->tc", slopes, covariance, slopes), 0.0))
    lower = np.fmin.reduce([prediction.samples - half, *elsewhere])
    upper = np.fmax.reduce([prediction.samples + half, *elsewhere])
    curves = group.curves(predicted=prediction.samples, lower=lower, upper=upper)
    channels = group.channels
    labels = {
        "channel": [f"{channel.sensor}/{channel.axis}" for channel in channels],
        "sensor": ("channel", [channel.sensor for channel in channels]),
        "axis": ("channel", [channel.axis for channel in channels]),
    }
    return curves.rename(std="noise").assign_coords(labels).assign_attrs(fitted=int(is_fitted))


def _loose_ends(fitted: Misfit, shown: Misfit, result: Identification) -> Iterator[list[Prediction]]:
    """The predictions with one parameter, of those not identified, at an end of its interval.

    Where the fit would be worse, others would have to follow: that is in the covariance.
    """
    values, table = result.values, result.parameters
    least = _cost(fitted, values)
    most = least + CONFIDENCE**2 * max(1.0, float(table.attrs["normalised_residual"]) ** 2)
    for name in table["parameter"].values[~table["identifiable"].values].tolist():
        for end in _ends(table.sel(parameter=name)):
            with suppress(SimulationError):
                moved = {**values, name: end}
                if _cost(fitted, moved) < most:
                    yield shown.predictor.predict(moved)


def _ends(row: xr.Dataset) -> list[float]:
    """Where the interval of a parameter ends."""
    value = float(row["value"])
    near, far = sorted((value / OPEN_END, value * OPEN_END))
    ends = np.fmax(row["interval_lower"], near), np.fmin(row["interval_upper"], far)
    return [float(np.clip(end, row["lower"], row["upper"])) for end in ends]


def _cost(misfit: Misfit, values: Mapping[str, float]) -> float:
    residual = misfit.discrepancy(misfit.start_at(values))
    return 0.5 * float(residual @ residual)
