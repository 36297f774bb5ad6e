"""Numbers that a search has driven far from the given ones, begun again from there: one joint after the other, and all."""

from collections.abc import Iterator, Mapping

from crashkit.diagnose.fitting.search import STEPS, Search, advance_all, begin_all
from crashkit.misfit import Misfit

FIRST_STEPS = 8
"""After which one that leaves more than the fit is given up."""


def eased(search: Search, given: Misfit) -> Search:
    """The fit, or a better one from where the numbers of one joint, or of all, are as the user gave them.

    A claim that is fitted from where the model without it had been driven comes to all but one of its numbers again: of
    densification that had stood in for it, begun early and soft, there is no way back.
    """
    begun = advance_all(
        begin_all(search.identifier, [search.fitted().with_values(v) for v in _given(search, given)]), FIRST_STEPS
    )
    ahead = [one for one in begun if one.state.cost < search.state.cost]
    return min([search, *advance_all(ahead, STEPS)], key=lambda one: one.state.cost)


def _given(search: Search, given: Misfit) -> Iterator[Mapping[str, float]]:
    """The given values, of each joint and of all."""
    known = {path: value for path, value in given.values(given.start()).items() if path in search.misfit.names}
    for joint in search.misfit.model.joints:
        own = {path: value for path, value in known.items() if path.startswith(f"joint.{joint.name}.")}
        if own:
            yield own
    yield known
