"""Forces of the rate alone."""

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, ENGAGEMENT, TENSION


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


class ViscousGrowing(SpringLaw):
    """A damper whose orifices close with the stroke: F = c ddot (1 + d / doubling_deformation) min(1, d / engagement).

    In contact only, d > 0; both ways.
    """

    name = "viscous_growing"
    parameters = (
        ParameterSpec("damping", "N s m-1", "force for a unit of rate at the first contact (c)", lower=0.0, null=0.0),
        ParameterSpec("doubling_deformation", "m", "deformation at which it has doubled", lower=1e-4),
        ENGAGEMENT,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, damping: float, doubling_deformation: float, engagement: float) -> float:
        """The force, N, compression positive."""
        pressed = max(0.0, d)
        return damping * ddot * (1.0 + pressed / doubling_deformation) * min(1.0, pressed / engagement)


class ViscousKnee(SpringLaw):
    """A damper whose valve opens: F = c v up to the rate v_k, and on from there with a slope of `beyond` c.

    Both ways, while in contact: F = c sign(ddot) (min(v, v_k) + beyond max(0, v - v_k)) min(1, max(0, d) / engagement) with
    v = |ddot|.
    """

    name = "viscous_knee"
    parameters = (
        ParameterSpec("damping", "N s m-1", "force for a unit of rate, at low rates (c)", lower=0.0, null=0.0),
        ParameterSpec("knee_rate", "m s-1", "rate at which the valve opens (v_k)", lower=1e-3),
        ParameterSpec("beyond", "1", "slope from there on, relative to that before", lower=0.0, upper=10.0),
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, damping: float, knee_rate: float, beyond: float, engagement: float
    ) -> float:
        """The force, N, compression positive."""
        slow = max(-knee_rate, min(knee_rate, ddot))
        return damping * (slow + beyond * (ddot - slow)) * min(1.0, max(0.0, d) / engagement)


class ViscousPower(SpringLaw):
    """A damper of any exponent: F = c ddot (ddot^2 + v^2)^((n - 1) / 2) max(tension, min(1, max(0, d) / engagement)).

    Rates are in m/s. n = 1 is a dashpot, n = 2 an orifice, n below 1 a relief valve or a seal; v = 0.01 m/s keeps the slope
    finite at rest. With `tension` 1 it is fixed at both ends and acts also where the joint is not compressed. On the way back
    (ddot < 0) the force is `rebound` times as much, as in a shock absorber whose valves differ.
    """

    name = "viscous_power"
    parameters = (
        ParameterSpec("damping", "N s m-1", "force for a unit of rate at 1 m/s (c)", lower=0.0, null=0.0),
        ParameterSpec("exponent", "1", "of the rate (n)", lower=0.1, upper=3.0),
        TENSION,
        ENGAGEMENT,
        ParameterSpec(
            "rebound", "1", "damping on the way back, relative to that while closing", 0.0, 10.0, default=1.0, null=1.0
        ),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        damping: float,
        exponent: float,
        tension: float,
        engagement: float,
        rebound: float,
    ) -> float:
        """The force, N, compression positive."""
        size = (ddot * ddot + 1e-4) ** (0.5 * (exponent - 1.0))
        if ddot < 0.0:
            size = size * rebound
        return damping * ddot * size * max(tension, min(1.0, max(0.0, d) / engagement))


class ViscousSaturating(SpringLaw):
    """A digressive damper: F = c ddot / (1 + |ddot| / v_s) max(tension, min(1, max(0, d) / engagement)).

    A dashpot at rates far below v_s, at which it reaches half of the force c v_s that it never exceeds. With `tension` 1 it is
    fixed at both ends and acts also where the joint is not compressed.
    """

    name = "viscous_saturating"
    parameters = (
        ParameterSpec("damping", "N s m-1", "force for a unit of rate, at low rates (c)", lower=0.0, null=0.0),
        ParameterSpec("saturating_rate", "m s-1", "rate at which it gives half of its limit (v_s)", lower=1e-3),
        TENSION,
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, damping: float, saturating_rate: float, tension: float, engagement: float
    ) -> float:
        """The force, N, compression positive."""
        size = damping / (1.0 + abs(ddot) / saturating_rate)
        return size * ddot * max(tension, min(1.0, max(0.0, d) / engagement))
