"""Forces estimated from data: values at knots, with no assumption on the shape."""

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import ENGAGEMENT

FORCE = ParameterSpec("force", "N", "force at the knots, of either sign", vector=True, null=0.0)


class SmoothTable(SpringLaw):
    """A force of the deformation, linear between knots: 0 up to d = 0, force[i] at (i + 1) range / n, constant after the last."""

    name = "smooth_table"
    passive = False
    parameters = (
        FORCE,
        ParameterSpec("range", "m", "deformation at the last knot", lower=1e-6, free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, force: list[float], range: float) -> float:
        """The force, N, compression positive."""
        knot = d / range * len(force)
        total = 0.0
        previous = 0.0
        for i, value in enumerate(force):
            total = total + (value - previous) * max(0.0, min(1.0, knot - i))
            previous = value
        return total


class RateTable(SpringLaw):
    """A force of the rate while in contact, linear between knots from -range to range, constant beyond.

    F = table(ddot) min(1, max(0, d) / engagement).
    """

    name = "rate_table"
    passive = False
    parameters = (
        FORCE,
        ParameterSpec("range", "m s-1", "rate at the last knot", lower=1e-6, free=False),
        ENGAGEMENT,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, force: list[float], range: float, engagement: float) -> float:
        """The force, N, compression positive."""
        knot = (ddot / range + 1.0) / 2.0 * (len(force) - 1)
        total = force[0]
        previous = force[0]
        for i, value in enumerate(force):
            total = total + (value - previous) * max(0.0, min(1.0, knot + 1 - i))
            previous = value
        return total * min(1.0, max(0.0, d) / engagement)
