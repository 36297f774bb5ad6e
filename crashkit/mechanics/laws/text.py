"""Lines of source."""

from collections.abc import Iterable

from crashkit.mechanics.laws.program import Branch


def taken(branch: Branch) -> str:
    """The test of a branch that is frozen: its bit of the mode, or the comparison if it knows only parameters."""
    return branch.comparison if branch.bit is None else f"mode & {1 << branch.bit}"


def when(test: str, body: list[str], orelse: list[str]) -> list[str]:
    """Lines that choose between two blocks."""
    if not body and not orelse:
        return []
    lines = [f"if {test}:", *indented(body or ["pass"])]
    return [*lines, "else:", *indented(orelse)] if orelse else lines


def indented(lines: Iterable[str]) -> list[str]:
    """The same lines one level deeper."""
    return [f"    {line}" for line in lines]
