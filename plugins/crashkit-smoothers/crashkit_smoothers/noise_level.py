"""Whether samples contradict the noise that they are said to have."""

import math

FULL = 0.5
"""Share of the samples' freedom above which a fit can hardly tell noise from motion."""
SURE = 4.0
"""Standard deviations of an estimated standard deviation by which it must differ from another."""


def exceeds(one: float, other: float, freedom: float) -> bool:
    """Whether a standard deviation that is estimated with so many degrees of freedom is beyond doubt above another."""
    return one > other * (1.0 + SURE / math.sqrt(2.0 * freedom))


def doubt(used: float, found: float, freedom: float) -> str:
    """What to tell of a given noise of 1: `used` is what was believed instead, `found` what the samples show."""
    if used != 1.0:
        return f"; the samples show {used:.2g} times the given noise, which is used instead"
    if exceeds(1.0, found, freedom):
        return f"; the samples show only {found:.2g} times the given noise"
    return ""
