"""Recordings as thin as a search can bear: in the light of a model, and finer where the model outruns the rate."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from crashkit.diagnose.workshop import Workshop
from crashkit.errors import SimulationError
from crashkit.misfit import Group
from crashkit.misfit.thin import thinned
from crashkit.model import Model

LITTLE = 0.5
"""Of the standard deviation of a reading: what thinning may do to a channel's readings, root mean square, for a search."""
RATES = 5
"""That are tried, each twice the last: what outruns 32 000 samples a second is no structure."""

Recordings = Mapping[str, xr.DataTree]


def thinned_by(workshop: Workshop, recordings: Recordings, model: Model) -> dict[str, xr.DataTree]:
    """The recordings at the rate of a search, each instrument at the lowest that bears what the model does.

    A mean rounds corners, and a filter at a low rate passes them otherwise than at a high one. So what the model expects is
    taken away before, and what it expects at the low rate is put back behind. Where that makes a difference, the rate is
    too low for models like it, and is doubled. Of a model that cannot be simulated nothing is expected.
    """
    workshop = workshop.equipped([model])
    halvings: dict[str, int] = {}
    try:
        rest = _with_expected(workshop, recordings, model, -1.0)
        for _ in range(RATES):
            corrected = _with_expected(workshop, _thin(workshop, rest, halvings), model, 1.0)
            outrun = _outrun(workshop, model, _thin(workshop, recordings, halvings), corrected)
            if not outrun:
                break
            halvings |= {name: halvings.get(name, 0) + 1 for name in outrun}
    except SimulationError:
        return _thin(workshop, recordings, {})
    return corrected


def _thin(workshop: Workshop, recordings: Recordings, halvings: Mapping[str, int]) -> dict[str, xr.DataTree]:
    quantities = {name: observer.quantity for name, observer in workshop.observers.items()}
    return {run: thinned(recording, quantities, halvings) for run, recording in recordings.items()}


def _outrun(workshop: Workshop, model: Model, plain: Recordings, corrected: Recordings) -> set[str]:
    """The instruments that a correction changes by more than a little of their noise."""
    groups, others = (workshop.first_misfit(model, one).groups for one in (plain, corrected))
    pairs = zip(groups, others, strict=True)
    return {group.name for group, other in pairs if _is_changed(group, group.recorded - other.recorded)}


def _is_changed(group: Group, change: np.ndarray) -> bool:
    weights, counts = zip(*((c.noise.weight, c.independent_samples) for c in group.channels), strict=True)
    return bool(np.any(np.nansum((change * weights) ** 2, axis=0) > LITTLE**2 * np.array(counts)))


def _with_expected(workshop: Workshop, recordings: Recordings, model: Model, share: float) -> dict[str, xr.DataTree]:
    """The recordings with a share of what the model expects every instrument to read added."""
    misfit = workshop.first_misfit(model, recordings)
    changed: dict[str, dict[str, xr.DataTree]] = {run: {} for run in recordings}
    predictions = misfit.predictor.predict_at(misfit.parameters(misfit.start()))
    for group, prediction in zip(misfit.groups, predictions, strict=True):
        quantity = group.observer.quantity
        instrument = recordings[group.run].children[group.name].to_dataset(inherit=False)
        readings = group.dataset[quantity].transpose("time", group.observer.channel, "axis")
        expected = readings.copy(data=np.nan_to_num(share * prediction.samples).reshape(readings.shape))
        known = expected.reindex_like(instrument[quantity], fill_value=0.0).transpose(*instrument[quantity].dims)
        together = instrument[quantity].copy(data=instrument[quantity].values + known.values)
        changed[group.run][group.name] = xr.DataTree(instrument.assign({quantity: together}))
    return {run: recording.assign(changed[run]) for run, recording in recordings.items()}
