"""How a load hangs on its carrier."""

from crashkit.protocols import ParameterSpec, SpringLaw


class Tie(SpringLaw):
    """A tie with slack that pushes and pulls: F = k (d - s) + c ddot for d > s, k (d + s) + c ddot for d < -s, 0 between.

    The dashpot sets in over the first millimetre beyond the slack, so that the force is continuous; a dashpot that
    would pull on a tie in compression, or push on one in tension, is let go.
    """

    name = "tie"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope beyond the slack (k)", lower=1.0),
        ParameterSpec("damping", "N s m-1", "force for a unit of rate beyond the slack (c)", lower=0.0, default=0.0),
        ParameterSpec("slack", "m", "free play either way (s)", lower=0.0, default=0.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, stiffness: float, damping: float, slack: float) -> float:
        """The force, N, compression positive."""
        if d >= 0.0:
            beyond = max(0.0, d - slack)
            return max(0.0, stiffness * beyond + damping * ddot * min(1.0, beyond / 1e-3))
        beyond = max(0.0, -d - slack)
        return min(0.0, damping * ddot * min(1.0, beyond / 1e-3) - stiffness * beyond)
