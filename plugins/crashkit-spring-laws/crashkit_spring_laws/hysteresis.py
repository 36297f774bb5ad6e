"""A member that yields in traction and in compression."""

from crashkit.protocols import ParameterSpec, SpringLaw


class BoucWen(SpringLaw):
    """Elastic-plastic both ways, through any number of reversals (Bouc 1967; Wen 1976, doi:10.1061/JMCEA3.0002106).

    F = h k d + (1 - h) F_y z;  z' = (k / F_y) ddot (1 - |z|^n) while ddot pushes z on, and (k / F_y) ddot on the way back.

    The memory z, from -1 to 1, is the yielding part of the force. Loading begins with the slope k, bends over at F_y and goes
    on with the slope h k; unloading begins with the slope k again. With h = 0 it is friction that sticks.
    """

    name = "bouc_wen"
    memory = "yielding"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope before yielding (k)", lower=1.0),
        ParameterSpec("yield_force", "N", "force at which it yields (F_y)", lower=1.0),
        ParameterSpec(
            "hardening",
            "1",
            "share of the slope that is left after yielding (h)",
            lower=0.0,
            upper=1.0,
            default=0.0,
            null=0.0,
        ),
        ParameterSpec("sharpness", "1", "of the bend (n)", lower=1.0, upper=20.0, default=2.0, free=False),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        yielding: float,
        stiffness: float,
        yield_force: float,
        hardening: float,
        sharpness: float,
    ) -> float:
        """The force, N, compression positive."""
        return hardening * stiffness * d + (1.0 - hardening) * yield_force * yielding

    @staticmethod
    def memory_rate(
        d: float,
        ddot: float,
        d_max: float,
        yielding: float,
        stiffness: float,
        yield_force: float,
        hardening: float,
        sharpness: float,
    ) -> float:
        """How fast the yielding part grows, 1/s."""
        elastic = stiffness / yield_force * ddot
        if ddot * yielding > 0.0:
            return elastic * (1.0 - abs(yielding) ** sharpness)
        return elastic
