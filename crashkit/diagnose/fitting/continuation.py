"""A search that takes in the recordings no faster than it understands them."""

from collections.abc import Mapping
from typing import Any

from attrs import evolve, frozen

from crashkit.diagnose.fitting.search import begin
from crashkit.misfit import Misfit
from crashkit.protocols import Identifier

MOST, LEAST = 0.08, 0.005
"""Shares of the time recorded that are taken in at once: at first, and where more misled the search again and again."""
LONGER = 1.5
"""By which factor the next share is, after one that was understood."""
MISLED = 1.3
"""The factor by which what is left may grow with a share that was understood."""
LOST = 100.0
"""Residual over noise of the least share from which no search comes back."""
STEPS = 12
"""For each share."""


@frozen
class _Seen:
    """How much of the time recorded was taken in, the values that it led to, and the residual over noise there."""

    share: float
    values: Mapping[str, float]
    left: float


def grown(identifier: Identifier[Any], misfit: Misfit) -> Mapping[str, float]:
    """The values to which a search from the misfit's own ones comes that sees the recordings little by little.

    An event that a wrong number shifts makes all that follows wrong at once. A search that is shown two more of them together
    settles on the wrong side of one, and leaves much more than before; then it is shown half as much. What it was not shown
    yet it leaves where the misfit's prior says. One that is lost ends where it still understood something: to go on would
    take very many steps, of forces that are beyond all measure.
    """
    seen, share = _Seen(0.0, misfit.values(misfit.start()), 1.0), MOST
    while seen.share < 1.0:
        ahead = _ahead(identifier, misfit.coarse, seen, min(1.0, seen.share + share))
        is_misled = ahead.left > MISLED * max(seen.left, 1.0)
        if is_misled and share > LEAST:
            share = max(0.5 * share, LEAST)
        elif is_misled and ahead.left > LOST:
            break
        else:
            seen, share = ahead, min(LONGER * share, MOST)
    return seen.values


def _ahead(identifier: Identifier[Any], misfit: Misfit, seen: _Seen, share: float) -> _Seen:
    """Where the search goes when it sees so much of the time."""
    early = misfit.up_to(share)
    if not early.groups:
        return evolve(seen, share=share)
    search = begin(identifier, early.with_values(seen.values)).advance(STEPS)
    return _Seen(share, early.values(search.point), search.normalised)
