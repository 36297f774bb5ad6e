"""What a model leaves of the recordings at its own values, beside the noise."""

import math

import numpy as np

from crashkit.diagnose.fitting.evidence import UNEXPLAINED, by_chance
from crashkit.misfit import Misfit

BY_CHANCE = 3.0
"""Standard deviations of what noise alone leaves of few samples."""
MOST = 0.5
"""Of the independent samples: channels whose noise is told speak for the others if they have more."""


def leaves_something(misfit: Misfit) -> bool:
    """Whether channels whose noise is told leave plainly more than that: more than 15 %, and than chance does."""
    left, samples = _left(misfit, told_only=True)
    return left > max(UNEXPLAINED, 1.0 + BY_CHANCE / math.sqrt(2.0 * max(samples, 1.0)))


def is_all_told(misfit: Misfit) -> bool:
    """Whether channels whose noise is told leave no more than chance does, and are most of what was recorded."""
    left, samples = _left(misfit, told_only=True)
    is_most = samples > MOST * sum(channel.independent_samples for channel in misfit.channels)
    return is_most and left < by_chance(samples)


def normalised(misfit: Misfit, told_only: bool) -> float:
    """Residual over noise of all channels, or of those whose noise is told; 0 if there are none."""
    return _left(misfit, told_only)[0]


def _left(misfit: Misfit, told_only: bool) -> tuple[float, float]:
    """The residual over noise, and of how many independent samples."""
    counted = np.array([channel.noise.trusted or not told_only for channel in misfit.channels])
    samples = float(counted @ [channel.independent_samples for channel in misfit.channels])
    squares = float(counted @ misfit.channel_sums(misfit.residual(misfit.start())))
    return math.sqrt(squares / max(samples, 1e-9)), samples
