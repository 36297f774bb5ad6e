"""The curves of a diagnosis, one channel at a time, with how well the model fits each."""

from collections.abc import Iterator

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit.diagnose.result import Diagnosis, Fit


@frozen
class ChannelFit:
    """How well one model predicts one channel; NaN where it was not rated."""

    normalised_rmse: float
    relative_rmse: float
    rating: float
    independent_samples: float


CURVES = ("recorded", "before", "after", "std")
UNRATED = ChannelFit(np.nan, np.nan, np.nan, np.nan)


@frozen
class ChannelCurves:
    """One channel of one run.

    Attributes:
        run, instrument, sensor: where it was recorded; the sensor with its axis where it has several.
        quantity, units: what it recorded.
        holdout: whether its run was never fitted.
        time: (time,) s.
        recorded, before, after, std: (time,) in `units`.
        fits: "before" and "after".
    """

    run: str
    instrument: str
    sensor: str
    quantity: str
    units: str
    holdout: bool
    time: np.ndarray
    recorded: np.ndarray
    before: np.ndarray
    after: np.ndarray
    std: np.ndarray
    fits: dict[str, ChannelFit]

    @property
    def correlation(self) -> float:
        """How many recorded samples make one independent one."""
        independent = self.fits["after"].independent_samples
        return max(1.0, float(np.isfinite(self.recorded).sum()) / independent) if independent > 0 else 1.0


def channels_of(diagnosis: Diagnosis) -> Iterator[ChannelCurves]:
    """Every channel with its curves, in the order of the diagnosis."""
    fits = {model: _by_channel(diagnosis, model) for model in ("before", "after")}
    for node in diagnosis.curves.leaves:
        group = node.to_dataset()
        run, _, instrument = node.path.strip("/").rpartition("/")
        for index, sensor in enumerate(group.get("channel", ())):
            yield _channel(group, index, (run, instrument, str(sensor.item())), fits)


def fits_of(fit: Fit) -> dict[str, ChannelFit]:
    """The fit of each channel by its name "run/instrument/sensor"."""
    table = fit.channels
    if "channel" not in table.sizes:
        return {}
    columns = [table[name].values.astype(float).tolist() for name in ChannelFit.__annotations__]
    return dict(zip((str(name).strip("/") for name in table["channel"].values), map(ChannelFit, *columns), strict=True))


def _by_channel(diagnosis: Diagnosis, model: str) -> dict[str, ChannelFit]:
    found: dict[str, ChannelFit] = {}
    for fits in diagnosis.fits.values():
        if model in fits:
            found |= fits_of(fits[model])
    return found


def _channel(
    group: xr.Dataset, index: int, name: tuple[str, str, str], fits: dict[str, dict[str, ChannelFit]]
) -> ChannelCurves:
    one = group.isel(channel=index)
    recorded, before, after, std = (np.broadcast_to(one[curve].values, one["time"].shape) for curve in CURVES)
    return ChannelCurves(
        *name,
        quantity=str(group.attrs.get("quantity", "")),
        units=str(group.attrs.get("units", "")),
        holdout=bool(group.attrs.get("holdout", 0)),
        time=group["time"].values,
        recorded=recorded,
        before=before,
        after=after,
        std=std,
        fits={model: fits[model].get("/".join(name), UNRATED) for model in fits},
    )
