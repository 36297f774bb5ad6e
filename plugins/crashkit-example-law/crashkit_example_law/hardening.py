"""A spring that hardens as it is compressed, and gives back less than it took."""

from crashkit.protocols import ParameterSpec, SpringLaw


class Hardening(SpringLaw):
    """Cubic loading, and a share of the force lost on the way back.

    F_load(d) = k d + c d^3;  F = max(0, F_load(d) - loss (F_load(d_max) - F_load(d))).
    """

    name = "hardening"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope at the origin (k)", lower=1.0),
        ParameterSpec("hardening", "N m-3", "cubic term (c)", lower=0.0, null=0.0),
        ParameterSpec("loss", "1", "share of the force that unloading loses", lower=0.0, default=0.0, null=0.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, stiffness: float, hardening: float, loss: float) -> float:
        """The force, N, compression positive."""
        x = max(0.0, d)
        loading = (stiffness + hardening * x * x) * x
        peak = (stiffness + hardening * d_max * d_max) * d_max
        return max(0.0, loading - loss * (peak - loading))
