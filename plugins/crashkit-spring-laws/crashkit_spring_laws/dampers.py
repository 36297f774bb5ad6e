"""Forces of the rate alone."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, ENGAGEMENT


class Viscous(SpringLaw):
    """A dashpot that also holds back on parting: F = c ddot min(1, max(0, d - clearance) / engagement)."""

    name = "viscous"
    parameters = (
        ParameterSpec("damping", "N s m-1", "force for a unit of rate (c)", lower=0.0, null=0.0),
        CLEARANCE,
        ENGAGEMENT,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, damping: float, clearance: float, engagement: float) -> float:
        """The force, N, compression positive."""
        return damping * ddot * min(1.0, max(0.0, d - clearance) / engagement)


class Coulomb(SpringLaw):
    """Dry friction that opposes the rate: F = friction_force tanh(ddot / slip_rate).

    Smooth, because a force that jumps with the sign of the rate would hold the joint on its jump. So what should stick creeps,
    by at most slip_rate; friction that sticks is `bouc_wen` without hardening.
    """

    name = "coulomb"
    parameters = (
        ParameterSpec("friction_force", "N", "force while sliding", lower=0.0, null=0.0),
        ParameterSpec("slip_rate", "m s-1", "rate at which sliding is established", lower=1e-3, default=0.05, free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, friction_force: float, slip_rate: float) -> float:
        """The force, N, compression positive."""
        return friction_force * math.tanh(ddot / slip_rate)
