"""How much of what a finding explains each run shows."""

import math

import numpy as np

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit


def run_drops(before: Misfit, after: Misfit) -> dict[str, float]:
    """By how much chi squared drops in each run, weighed as before; infinite where the model cannot be simulated before."""
    try:
        alike = [misfit.channel_sums(misfit.residual(misfit.start())) * _levels(misfit) ** 2 for misfit in (before, after)]
    except SimulationError:
        return dict.fromkeys(before.recordings, math.inf)
    drops = (alike[0] - alike[1]) / _levels(before) ** 2
    runs = [channel.run for channel in before.channels]
    return {run: float(np.sum(drops[[r == run for r in runs]])) for run in before.recordings}


def _levels(misfit: Misfit) -> np.ndarray:
    return np.array([channel.noise.std for channel in misfit.channels])
