"""How dry friction, in a joint or on the ground, depends on the rate of sliding."""

from crashkit.model import Parameter

SLIP_RATE, FASTEST_SLIP = 0.4, 3.0
"""m/s: how fast smooth friction slides once it is established, to start from, and at most."""
TAIL = {"tail": Parameter(1.0, -0.5, 2.5)}
"""Of smooth friction that is long in reaching its full force."""
BACK = {"rebound": Parameter(1.0, 0.0, 10.0)}
"""Of friction that is another on the way back, as of wedges."""
REFINED = ("smooth and falling", "smooth with a tail", "two-way")
"""The forms of friction that are only tried where another was found: they take many shapes."""
MOST_RISING = -0.5
"""Of friction that rises with the rate, what it has less at first: more would be a damper."""
SLOWEST = 0.5
"""m/s, below which friction is not asked how it changes with the rate."""


def smooth(fastest: float) -> dict[str, Parameter]:
    """Of friction: how fast it slides once it is established, m/s. Beyond the fastest there was it would be a damper."""
    fastest = min(max(fastest, SLOWEST), FASTEST_SLIP)
    return {"slip_rate": Parameter(min(SLIP_RATE, 0.3 * fastest), 0.01, fastest)}


def falling(fastest: float) -> dict[str, Parameter]:
    """Parameters of friction that changes with the rate, m/s, up to the fastest there was."""
    fastest = max(fastest, SLOWEST)
    return {
        "friction_force": Parameter(0.0, 0.0, 1e7),
        "slip_rate": Parameter(0.05, fixed=True),
        "stick": Parameter(0.3, MOST_RISING, 9.0),
        "stick_rate": Parameter(0.2 * fastest, 0.02 * fastest, 2.0 * fastest),
    }
