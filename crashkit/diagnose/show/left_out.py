"""Whether a piece of physics predicts the runs that it was not fitted to."""

from typing import Any

import numpy as np

from crashkit.diagnose.fitting.search import Search, begin
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier

STEPS = 8
"""From a fit to all runs to one without one of them it is not far."""


def left_out_drop(before: Misfit, after: Search) -> float:
    """By how much chi squared of every run drops when a model with the physics predicts it, instead of one without.

    Each model is fitted to all runs but one, which it then predicts; the drops of all runs are added. NaN where there is one
    run only.

    Arguments:
        before: the model without, at its best fit.
        after: the fit of the model with the physics.
    """
    if len(before.recordings) < 2:
        return float("nan")
    identifier, fitted = after.identifier, after.fitted()
    try:
        return sum(_chi_squared(identifier, before, run) - _chi_squared(identifier, fitted, run) for run in before.recordings)
    except SimulationError:
        return float("nan")


def _chi_squared(identifier: Identifier[Any], misfit: Misfit, run: str) -> float:
    """Of a run that is predicted from the others."""
    others = tuple(other for other in misfit.recordings if other != run)
    found = begin(identifier, misfit.with_recordings(others)).advance(STEPS)
    unseen = misfit.with_values(found.values).with_recordings((run,))
    return float(np.sum(unseen.channel_sums(unseen.residual(unseen.start()))))
