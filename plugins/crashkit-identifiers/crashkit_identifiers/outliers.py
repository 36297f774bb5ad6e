"""Which residuals are outliers, and whether the others are no larger than their noise."""

import numpy as np
from attrs import frozen

from crashkit.misfit import Misfit
from crashkit.misfit.noise import robust_std
from crashkit.protocols import Problem

FAR = 5.0
"""Standard deviations beyond which a reading is an outlier: one of two million."""
MOST = 0.2
"""Share of the readings that may be outliers; more of them are a model that is wrong."""
CHANCE = 3.0
"""Standard deviations of χ² that are chance."""


@frozen(eq=False)
class Verdict:
    """What residuals look like.

    Arguments:
        kept: which of them are no outliers.
        at_noise: whether those are no larger than chance allows.
    """

    kept: np.ndarray
    at_noise: bool


def judged(problem: Problem, residual: np.ndarray) -> Verdict:
    """A verdict on residuals.

    A reading is an outlier beyond 5 max(1, s), with s a robust scale of its channel's residuals: where a model is wrong all
    along, all of them are large, and none is an outlier. Where most of a channel fits, all of the rest is.
    """
    channels, correlation = _channels(problem, len(residual))
    residual = residual[: len(channels)]  # without those of a prior
    away = np.abs(residual) * np.sqrt(correlation)
    kept = np.ones(len(residual), dtype=bool)
    for channel in np.unique(channels):
        own = channels == channel
        kept[own] = away[own] <= FAR * max(1.0, robust_std(away[own]))
    freedom = max(float(np.sum(1.0 / correlation[kept])) - len(problem.names), 1.0)
    excess = float(residual[kept] @ residual[kept]) / freedom
    few = np.count_nonzero(~kept) <= MOST * len(kept)
    return Verdict(kept, bool(few and excess < 1.0 + CHANCE * np.sqrt(2.0 / freedom)))


def independent(problem: Problem, kept: np.ndarray) -> float:
    """How many independent readings those that are kept amount to."""
    return float(np.sum(1.0 / _channels(problem, len(kept))[1][kept]))


def left_out(problem: Misfit, kept: np.ndarray) -> dict[str, float]:
    """The share of its readings that is left out of every channel that loses any, by the channel's name."""
    numbers = _channels(problem, len(kept))[0]
    shares = {
        channel.name: float(np.mean(~kept[numbers == i])) for i, channel in enumerate(problem.channels) if channel.samples
    }
    return {name: share for name, share in shares.items() if share > 0.0}


def told(problem: Problem, kept: np.ndarray) -> str:
    """The outliers in words; empty where there are none."""
    lost = int(np.count_nonzero(~kept))
    if not lost:
        return ""
    where = f" ({', '.join(left_out(problem, kept))})" if isinstance(problem, Misfit) else ""
    return f"{lost} of {len(kept)} readings are outliers and were left out{where}."


def _channels(problem: Problem, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The number of each residual's channel, and the samples that make one independent one."""
    if not isinstance(problem, Misfit):
        return np.zeros(count, dtype=int), np.ones(count)
    numbers, first = [], 0
    for group in problem.groups:
        columns = np.broadcast_to(first + np.arange(len(group.channels)), group.recorded.shape)
        numbers.append(columns[np.isfinite(group.recorded)])
        first += len(group.channels)
    channels = np.concatenate(numbers)
    return channels, np.array([channel.noise.correlation for channel in problem.channels])[channels]
