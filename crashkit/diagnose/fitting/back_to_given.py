"""Numbers that a search has driven far from the given ones, begun again from there: one joint after the other, and all."""

from collections.abc import Iterator, Mapping

from crashkit.diagnose.fitting.search import Search, begun_again
from crashkit.misfit import Misfit


def begun_from_given(search: Search, given: Misfit) -> Search:
    """The fit, or a better one from where the numbers of one joint, or of all, are as the user gave them.

    A claim that is fitted from where the model without it had been driven comes to all but one of its numbers again: of
    densification that had stood in for it, begun early and soft, there is no way back.
    """
    return begun_again(search, _given(search, given))


def begun_at_given(search: Search, given: Misfit, joint: str) -> Search:
    """The fit, or a better one from where the numbers of this joint are as the user gave them."""
    own = _of_joint(_known(search, given), joint)
    return begun_again(search, [own]) if own else search


def _given(search: Search, given: Misfit) -> Iterator[Mapping[str, float]]:
    """The given values, of each joint and of all."""
    known = _known(search, given)
    for joint in search.misfit.model.joints:
        own = _of_joint(known, joint.name)
        if own:
            yield own
    yield known


def _known(search: Search, given: Misfit) -> Mapping[str, float]:
    return {path: value for path, value in given.values(given.start()).items() if path in search.misfit.names}


def _of_joint(values: Mapping[str, float], joint: str) -> Mapping[str, float]:
    return {path: value for path, value in values.items() if path.startswith(f"joint.{joint}.")}
