"""Does a search of the plane model's 78 parameters arrive at what film and accelerometers can tell?"""

from time import process_time

import numpy as np
import xarray as xr

from benchmarks.paper.plane import BOTH, FOLDER, line, misfit_of, relative_bounds
from crashkit.api import load_model
from crashkit.misfit import Misfit
from crashkit.registry import load
from crashkit_identifiers.multi_start import MultiStart
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity

METHODS = {"multi_start": MultiStart(least_drop=1e-3), "sensitivity": Sensitivity(least_drop=1e-3)}
SPREADS = (0.1, 0.3)
"""Of the starts about the true values, relative."""
STARTS = 2
KNOWN = 0.05
"""Relative standard deviation, at the bound, of the parameters whose errors count."""
HEAD = ("starts within", "method", "residual over noise", "error over the bound, root mean square", "within three bounds", "s")


def as_markdown() -> str:
    """From starts about the truth: what is left, and the errors of the parameters that can be known, over the bound."""
    rows = [_row(spread, method, seed) for spread in SPREADS for method in METHODS for seed in range(STARTS)]
    return "\n".join([line(HEAD), "|" + " --- |" * len(HEAD), *rows])


def _row(spread: float, method: str, seed: int) -> str:
    random = np.random.default_rng(seed)
    truth = _recorded(random)
    exact = truth.parameters(truth.start())
    jacobian = truth.residual_and_jacobian(truth.start())[1] * np.abs(exact) / truth.scaling(truth.start())
    bounds = relative_bounds(jacobian.T @ jacobian)
    start = exact * np.exp(spread * random.uniform(-1.0, 1.0, len(exact)))
    began = process_time()
    found = run(METHODS[method], truth.with_values(dict(zip(truth.names, start.tolist(), strict=True))))
    seconds = process_time() - began
    values = np.array([found.values[name] for name in truth.names])
    left = np.sqrt(np.sum(truth.residual(truth.scaled(values)) ** 2) / truth.independent_samples)
    errors = ((values / exact - 1.0) / bounds)[bounds < KNOWN]
    inside = f"{np.sum(np.abs(errors) < 3.0)} of {len(errors)}"
    size = np.sqrt(np.mean(errors**2))
    return line([f"{100 * spread:g} %", method, f"{left:.2f}", f"{size:.2g}", inside, f"{seconds:.0f}"])


def _recorded(random: np.random.Generator) -> Misfit:
    """The misfit, at the true values, to a noisy test against the orthogonal barrier."""
    registry, model = load(), load_model(FOLDER / "orthogonal.toml")
    silent = misfit_of(model, BOTH)
    trees = {name: node.to_dataset(inherit=False) for name, node in silent.recordings["run"].children.items()}
    for group, prediction in zip(silent.groups, silent.predictor.predict_at(silent.parameters(silent.start())), strict=True):
        stds = np.array([channel.noise.std for channel in group.channels])
        readings = prediction.samples + stds * random.normal(size=prediction.samples.shape)
        recorded = trees[group.name][group.observer.quantity]
        trees[group.name][group.observer.quantity] = recorded.copy(data=readings.reshape(recorded.shape))
    tree = silent.recordings["run"].assign({name: xr.DataTree(tree) for name, tree in trees.items()})
    return Misfit(model, {"run": tree}, registry.spring_laws, registry.observers, silent.simulator.engine)
