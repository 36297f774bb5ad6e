"""How long a step of the integration may be: its error must be little beside the noise."""

import numpy as np

from crashkit.errors import SimulationError
from crashkit.misfit.problem import Misfit

LITTLE = 0.1
"""Of the standard deviation of a reading; such an error adds a hundredth to chi squared."""
HALVINGS = 5


def fine_step(misfit: Misfit) -> float:
    """The longest step, s, with which every channel reads what it reads with half of it, to a tenth of its noise.

    Arguments:
        misfit: whose step is halved as often as it takes, but no more than five times; it stays as it is where the model
            cannot be simulated at its own values.
    """
    try:
        before = misfit.residual(misfit.start())
        for _ in range(HALVINGS):
            finer = misfit.with_step(0.5 * misfit.step)
            after = finer.residual(finer.start())
            if _largest(misfit, before - after) < LITTLE:
                break
            misfit, before = finer, after
    except SimulationError:
        pass
    return misfit.step


def _largest(misfit: Misfit, difference: np.ndarray) -> float:
    """Root mean square of the worst channel."""
    samples = np.array([channel.samples for channel in misfit.channels])
    return float(np.sqrt(np.max(misfit.channel_sums(difference) / np.maximum(samples, 1), initial=0.0)))
