"""How long a step of the integration may be: its error must be little beside the noise."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from crashkit.errors import SimulationError

if TYPE_CHECKING:
    from crashkit.misfit.problem import Misfit

LITTLE = 0.02
"""Of the standard deviation of a reading: what moves twice as fast as the model still has but a third of it."""
BEARABLE = 0.1
"""Of it: such an error adds a hundredth to chi squared."""
HARDLY = 1e-3
"""Of what the model leaves of a channel whose noise level is only an estimate: that may be next to none, and to be as exact
took steps of 4 us."""
CRUDE = 0.1
"""Of what the model leaves: a search still sees where it goes. Less than the noise is not asked for."""
STRIDE = 4.0
"""Times the usual time between two instants: what happens in one step, the recordings hardly show."""
LONGEST = 2e-3
"""s: a fifth of the period of a mass of 100 kg on a spring of 4 MN/m. Of longer ones two may miss the same blow and agree."""
TRIES = 6
ORDER = 4.0
"""Of the integration: the power of the step that its error goes with."""
CLOSE = 0.9
"""Of the step that would be just short enough by that power."""
SHORTER = 0.25, 0.8
"""A step becomes no less, and no more, of itself at a time."""


def fine_step(misfit: "Misfit") -> float:
    """The longest step, s, with which every channel reads what it reads with a third of it, to a fiftieth of its noise.

    Or, where the noise is only an estimate, to a thousandth of what the model leaves, if that is more.

    Arguments:
        misfit: whose model is simulated at its own values; where it cannot be, the step stays a short one.
    """
    first = min(STRIDE * misfit.predictor.usual_gap, LONGEST)
    open_ = np.array([not channel.noise.trusted for channel in misfit.channels])
    return _longest_step(misfit, first, lambda left: np.maximum(HARDLY * left * open_, LITTLE))


def crude_step(misfit: "Misfit") -> float:
    """The same, to its noise or to a tenth of what the model leaves, whichever is more; no longer than the misfit's own."""
    return _longest_step(misfit, misfit.step, lambda left: np.maximum(CRUDE * left, 1.0))


def bears_step(misfit: "Misfit") -> bool:
    """Whether the error of a misfit's own step is bearable."""
    return _share(misfit, lambda left: np.full_like(left, BEARABLE)) <= 1.0


def _longest_step(misfit: "Misfit", first: float, allowed: Callable[[np.ndarray], np.ndarray]) -> float:
    step = min(first, misfit.predictor.longest_step)
    for _ in range(TRIES):
        share = _share(misfit.with_step(step), allowed)
        if share <= 1.0:
            break
        step *= float(np.clip(CLOSE * share ** (-1.0 / ORDER), *SHORTER))
    return step


def _share(misfit: "Misfit", allowed: Callable[[np.ndarray], np.ndarray]) -> float:
    """The error of a step over what is allowed of it where the model leaves so much, in the channel where that is most."""
    # Not with half: where a step jumps over a corner the engine halves it anyway.
    finer = misfit.with_step(misfit.step / 3.0)
    try:
        before, after = (one.residual(one.start()) for one in (misfit, finer))
    except SimulationError:
        return np.inf
    return float(np.max(_by_channel(misfit, before - after) / allowed(_by_channel(misfit, after)), initial=0.0))


def _by_channel(misfit: "Misfit", residual: np.ndarray) -> np.ndarray:
    """Root mean square of each."""
    samples = np.array([channel.samples for channel in misfit.channels])
    return np.sqrt(misfit.channel_sums(residual) / np.maximum(samples, 1))
