# mypy: disable-error-code=empty-body
"""Stands for what an engine puts before the kernel's text: the compiler, the laws, and the geometry of its number of axes."""

from crashkit.mechanics.kernel.arrays import Floats


def compiled(function):  # type: ignore[no-untyped-def]
    """The compiler."""
    return function


def inlined(function):  # type: ignore[no-untyped-def]
    """The compiler, for small functions of the inner loops: a call with many arrays costs as much as they do."""
    return function


def unaliased(function):  # type: ignore[no-untyped-def]
    """The same, for loops over columns: none of the arrays that such a function is given overlaps another."""
    return function


def law_mode(code: int, d: float, ddot: float, d_max: float, z: float, p: Floats, o: int) -> int:
    """The branches that the function at `code` takes."""


def law_frozen(code: int, mode: int, d: float, ddot: float, d_max: float, z: float, p: Floats, o: int) -> tuple[float, float]:
    """Value and smallest guard with the branches of `mode`."""


def law_distance(code: int, which: int, mode: int, d: float, ddot: float, d_max: float, z: float, p: Floats, o: int) -> float:
    """The guard of branch `which`; infinity where the branches of `mode` do not come by it."""


def law_partials(code: int, mode: int, d: float, ddot: float, d_max: float, z: float, p: Floats, o: int, out: Floats) -> float:
    """Value, and into `out` its derivatives to d, ddot, d_max, z and the parameters."""


def law_guard(code: int, mode: int, d: float, ddot: float, d_max: float, z: float, p: Floats, o: int, out: Floats) -> float:
    """Smallest guard, and into `out` its derivatives, for a function whose value may jump; infinity for the others."""
