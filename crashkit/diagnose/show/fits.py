"""How well a model predicts: fits by channel, and the curves behind them."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit.diagnose.fitting.evidence import UNEXPLAINED
from crashkit.diagnose.result import Fit
from crashkit.misfit import Group, Misfit
from crashkit.misfit.predictor import Prediction
from crashkit.misfit.rating import rating

WORSE = 0.05
"""By which a prediction must be worse than before to be called so: less is the scatter of noise."""
BEYOND = 1.15
"""Factor beyond what is expected of the right model from which a prediction speaks against the model."""


def predict(misfit: Misfit) -> list[Prediction]:
    """The predictions of the misfit's model at its own values, one for each group."""
    return misfit.predictor.predict(misfit.model.values())


def fit_of(misfit: Misfit, predictions: Sequence[Prediction]) -> Fit:
    """Size of the residuals against the noise, and ISO/TS 18571 rating, overall and by channel."""
    rows = [
        row
        for group, prediction in zip(misfit.groups, predictions, strict=True)
        for row in _channels(group, prediction.samples)
    ]
    names = [channel.name for channel in misfit.channels]
    squares, relative, ratings, counts = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    table = xr.Dataset(
        {
            "normalised_rmse": ("channel", np.sqrt(squares / np.maximum(counts, 1e-9))),
            "relative_rmse": ("channel", relative),
            "rating": ("channel", ratings),
            "independent_samples": ("channel", counts),
        },
        coords={"channel": names},
    )
    return Fit(float(np.sqrt(squares.sum() / max(counts.sum(), 1e-9))), table)


def is_worse(fits: Mapping[str, Fit]) -> bool:
    """Whether the held-out runs are predicted worse than before."""
    return fits["after"].normalised_rmse > fits["before"].normalised_rmse + WORSE


def is_beyond(fits: Mapping[str, Fit]) -> bool:
    """Whether the held-out runs are predicted worse than the right model would predict them; not where that is not known."""
    return fits["after"].normalised_rmse > BEYOND * fits["after"].expected_rmse


def is_explained(fits: Mapping[str, Fit]) -> bool:
    """Whether other values of the same model explain the held-out runs as well as the fitted ones."""
    return fits["after"].together_rmse < UNEXPLAINED


def is_misleading(fits: Mapping[str, Fit]) -> bool:
    """Whether the held-out runs are predicted worse, and beyond, and no other values are known to explain them."""
    return bool(fits) and is_worse(fits) and is_beyond(fits) and not is_explained(fits)


def curves_of(
    before: Misfit, after: Misfit, predictions: tuple[list[Prediction], list[Prediction]], holdout: bool
) -> dict[str, xr.Dataset]:
    """Recorded, before and after by `run/instrument`, over (time, channel)."""
    return {
        f"{group.run}/{group.name}": _curve(group, first.samples, second.samples, holdout)
        for group, first, second in zip(before.groups, *predictions, strict=True)
    }


def _curve(group: Group, before: np.ndarray, after: np.ndarray, holdout: bool) -> xr.Dataset:
    return group.curves(before=before, after=after).assign_attrs(holdout=int(holdout))


def _channels(group: Group, predicted: np.ndarray) -> list[tuple[float, float, float, float]]:
    rows = []
    for column, channel in enumerate(group.channels):
        recorded = group.recorded[:, column]
        both = np.isfinite(recorded) & np.isfinite(predicted[:, column])
        residual = (recorded - predicted[:, column])[both]
        moving = recorded[both] - (recorded[both][0] if group.observer.quantity == "position" else 0.0)
        size = float(np.sqrt(np.mean(moving**2))) if both.any() else np.nan
        relative = float(np.sqrt(np.mean(residual**2)) / size) if both.any() and size > 0 else np.nan
        squares = float(np.sum((residual * channel.noise.weight) ** 2))
        independent = float(both.sum() / channel.noise.correlation)
        rows.append((squares, relative, _rating(group.times, recorded, predicted[:, column]), independent))
    return rows


def _rating(times: np.ndarray, recorded: np.ndarray, predicted: np.ndarray) -> float:
    """Over the time that both cover, on even steps."""
    both = np.isfinite(recorded) & np.isfinite(predicted)
    if both.sum() < 10:
        return np.nan
    even = np.linspace(times[both][0], times[both][-1], int(both.sum()))
    reference, simulated = (np.interp(even, times[both], values[both]) for values in (recorded, predicted))
    return rating(reference, simulated, float(even[1] - even[0])).total
