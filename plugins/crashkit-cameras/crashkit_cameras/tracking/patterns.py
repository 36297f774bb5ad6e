"""The patterns by name."""

from crashkit.errors import CrashkitError
from crashkit_cameras.tracking.dot import Dot
from crashkit_cameras.tracking.pattern import Pattern
from crashkit_cameras.tracking.quadrant import Quadrant

PATTERNS: dict[str, Pattern] = {pattern.name: pattern for pattern in (Quadrant(), Dot())}


def pattern_of(kind: str) -> Pattern:
    """The pattern of a kind of target.

    Raises CrashkitError for a kind that is not known.
    """
    if kind not in PATTERNS:
        raise CrashkitError(f"kind of target: expected one of {', '.join(PATTERNS)}, found {kind!r}")
    return PATTERNS[kind]
