"""Whether a piece of physics predicts the runs that it was not fitted to."""

from typing import Any

import numpy as np

from crashkit.diagnose.fitting.search import begin
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier

STEPS = 8
"""From a fit to all runs to one without one of them it is not far."""


def left_out_sum(identifier: Identifier[Any], misfit: Misfit) -> float:
    """Chi squared of all runs, each predicted by a model that is fitted to the others.

    That of a model without a piece of physics, less that of one with it, tells whether it predicts what it was not fitted to.
    NaN where there is one run only.

    Arguments:
        misfit: of the model, at its best fit to all.
    """
    if len(misfit.recordings) < 2:
        return float("nan")
    try:
        return sum(_chi_squared(identifier, misfit, run) for run in misfit.recordings)
    except SimulationError:
        return float("nan")


def _chi_squared(identifier: Identifier[Any], misfit: Misfit, run: str) -> float:
    """Of a run that is predicted from the others."""
    others = tuple(other for other in misfit.recordings if other != run)
    found = begin(identifier, misfit.with_recordings(others)).advance(STEPS)
    unseen = misfit.with_values(found.values).with_recordings((run,))
    return float(np.sum(unseen.channel_sums(unseen.residual(unseen.start()))))
