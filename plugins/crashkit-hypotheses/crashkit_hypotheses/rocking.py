"""What sensors read of a body that rocks about an axis which the model leaves out."""

from crashkit.model import Parameter

TURNS = (0.2, 0.7, 2.0)
"""How often a body rocks in a run, to start from."""
FEWEST, MOST = 0.1, 10.0
"""The same, that is believed. A car pitches on its suspension at 1 to 2 Hz: a quarter of a turn in a crash."""
ERRORS = ("rocking_share", "rocking_frequency", "rocking_damping")
"""Of a sensor on that body."""


def rocking(duration: float) -> dict[str, Parameter]:
    """These errors in runs of this length, s."""
    share = Parameter(0.0, -2.0, 2.0)
    frequency = Parameter(1.0 / duration, FEWEST / duration, MOST / duration)
    return dict(zip(ERRORS, (share, frequency, Parameter(0.3, 0.01, 0.95)), strict=True))
