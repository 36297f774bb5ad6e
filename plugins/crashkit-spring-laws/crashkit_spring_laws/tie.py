"""How a load hangs on its carrier."""

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import NEVER


class Tie(SpringLaw):
    """A tie with slack that pushes and pulls: F = k (|d| - s) sign(d) + c ddot beyond the slack s, 0 within it.

    A tie in compression may yield, as a belt does: then its spring force is at most `yield_force`, and it falls along
    `unloading_stiffness` from the largest compression on. The dashpot sets in over the first millimetre beyond the slack, so
    that the force is continuous; one that would pull on a tie in compression, or push on one in tension, is let go, unless it
    `holds`.
    """

    name = "tie"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope beyond the slack (k)", lower=1.0),
        ParameterSpec("damping", "N s m-1", "force for a unit of rate beyond the slack (c)", lower=0.0, default=0.0),
        ParameterSpec("slack", "m", "free play either way (s)", lower=0.0, default=0.0),
        ParameterSpec(
            "yield_force", "N", "the most that the spring bears in compression", lower=1.0, default=NEVER, null=NEVER
        ),
        ParameterSpec(
            "unloading_stiffness",
            "N m-1",
            "slope of unloading from compression; omitted (0): unloads along the loading curve",
            lower=1.0,
            default=0.0,
            null=0.0,
        ),
        ParameterSpec(
            "holds",
            "1",
            "1 where the dashpot stays attached on the way back, 0 where it is let go",
            0.0,
            1.0,
            default=0.0,
            free=False,
            null=0.0,
        ),
        ParameterSpec("stiffening", "m-1", "relative rise of k for each metre beyond the slack", 0.0, default=0.0, null=0.0),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        stiffness: float,
        damping: float,
        slack: float,
        yield_force: float,
        unloading_stiffness: float,
        holds: float,
        stiffening: float,
    ) -> float:
        """The force, N, compression positive."""
        if d >= 0.0:
            turn = d_max if unloading_stiffness > 0.0 else d
            pressed = max(0.0, turn - slack)
            spring = min(yield_force, stiffness * pressed * (1.0 + stiffening * pressed)) - unloading_stiffness * (turn - d)
            engaged = min(1.0, max(0.0, d - slack) / 1e-3)
            total = max(0.0, spring) + damping * ddot * engaged
            return total if holds > 0.0 else max(0.0, total)
        beyond = max(0.0, -d - slack)
        total = damping * ddot * min(1.0, beyond / 1e-3) - stiffness * beyond * (1.0 + stiffening * beyond)
        return total if holds > 0.0 else min(0.0, total)
