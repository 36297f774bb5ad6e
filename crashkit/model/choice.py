"""A name that is none of those that are known: what is told of it."""

from collections.abc import Iterable

from crashkit.data.validate import names, shown
from crashkit.errors import Fault, did_you_mean


def choice_fault(where: str, noun: str, found: str, known: Iterable[str]) -> Fault:
    """One of the known names is expected; they are listed where none of them is close to the one that was found.

    Arguments:
        where: the place that the fault names.
        noun: what the known names are names of, in the plural.
        found: the name that is none of them.
        known: the names to choose from.
    """
    known = list(known)
    hint = did_you_mean(found, known)
    return Fault(where, f"one of the {noun}" if hint else f"one of the {noun} ({names(known) or 'none'})", shown(found) + hint)
