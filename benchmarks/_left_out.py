"""How well a model predicts blocks of time that it was not fitted to."""

import numpy as np
import xarray as xr

from crashkit.diagnose.diagnosis import ROUGHLY
from crashkit.misfit import Misfit, fine_step
from crashkit.model import Model
from crashkit.registry import load
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity


def left_out(model: Model, given: Model, recording: xr.DataTree, width: float) -> dict[str, float]:
    """Relative residual (rms over rms) of each instrument in blocks of `width` s, each predicted from all other samples.

    Each fit begins at the model's own values, so that numbers stay there which only the block tells: that flatters. The given
    model's values are believed as a diagnosis believes them, and channels are weighed by what the model leaves.
    """
    laws, observers = load().spring_laws, load().observers
    whole = Misfit(model, {"run": recording}, laws, observers)
    whole = whole.with_step(fine_step(whole))
    weighed = whole.reweighted(whole.start())
    levels = {(c.instrument, c.sensor, c.axis): c.noise for c in weighed.channels}
    missed, size = np.zeros(len(whole.groups)), np.zeros(len(whole.groups))
    for start in np.arange(0.0, max(group.times[-1] for group in whole.groups), width):
        block = {"run": without(recording, start, start + width)}
        believed = Misfit(given, block, laws, observers, whole.simulator.engine, whole.step)
        partial = believed.with_levels(levels).with_prior(ROUGHLY).with_model(model, laws, whole.simulator.engine)
        found = run(Sensitivity(least_drop=1e-3), partial)
        for number, (group, told) in enumerate(zip(whole.groups, whole.predictor.predict(found.values), strict=True)):
            inside = (group.times >= start) & (group.times < start + width)
            missed[number] += np.nansum((group.recorded - told.samples)[inside] ** 2)
            size[number] += np.nansum(group.recorded[inside] ** 2)
    return {group.name: float(np.sqrt(m / s)) for group, m, s in zip(whole.groups, missed, size, strict=True)}


def without(recording: xr.DataTree, start: float, end: float) -> xr.DataTree:
    """The recording, its samples from `start` to before `end`, s, hidden."""
    observers, groups = load().observers, {}
    for name, node in recording.children.items():
        dataset = node.to_dataset(inherit=False)
        if "observer" in dataset.attrs:
            quantity = observers[dataset.attrs["observer"]].quantity
            hidden = (dataset["time"] >= start) & (dataset["time"] < end)
            groups[name] = xr.DataTree(dataset.assign({quantity: dataset[quantity].where(~hidden)}))
    return recording.assign(groups)
