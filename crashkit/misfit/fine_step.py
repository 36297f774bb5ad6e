"""How long a step of the integration may be: its error must be little beside the noise."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from crashkit.errors import SimulationError

if TYPE_CHECKING:
    from crashkit.misfit.problem import Misfit

LITTLE = 0.1
"""Of the standard deviation of a reading; such an error adds a hundredth to chi squared."""
CRUDE = 0.1
"""Of what the model leaves: a search still sees where it goes. Less than the noise is not asked for."""
HALVINGS = 5


def fine_step(misfit: "Misfit") -> float:
    """The longest step, s, with which every channel reads what it reads with a third of it, to a tenth of its noise.

    Arguments:
        misfit: whose step is halved as often as it takes, but no more than five times, from the longest time between two
            readings, if that is shorter; no further where the model cannot be simulated at its own values.
    """
    return _longest_step(misfit, lambda left: np.full_like(left, LITTLE))


def crude_step(misfit: "Misfit") -> float:
    """The same, to its noise or to a tenth of what the model leaves, whichever is more."""
    return _longest_step(misfit, lambda left: np.maximum(CRUDE * left, 1.0))


def _longest_step(misfit: "Misfit", allowed: Callable[[np.ndarray], np.ndarray]) -> float:
    misfit = misfit.with_step(min(misfit.step, misfit.predictor.longest_gap))
    try:
        for _ in range(HALVINGS):
            # Not with half: where a step jumps over a corner the engine halves it anyway.
            finer = misfit.with_step(misfit.step / 3.0)
            before, after = (one.residual(one.start()) for one in (misfit, finer))
            if np.all(_by_channel(misfit, before - after) < allowed(_by_channel(misfit, after))):
                break
            misfit = misfit.with_step(0.5 * misfit.step)
    except SimulationError:
        pass
    return misfit.step


def _by_channel(misfit: "Misfit", residual: np.ndarray) -> np.ndarray:
    """Root mean square of each."""
    samples = np.array([channel.samples for channel in misfit.channels])
    return np.sqrt(misfit.channel_sums(residual) / np.maximum(samples, 1))
