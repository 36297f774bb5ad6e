"""Forces that relax while the deformation is held."""

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, ENGAGEMENT, TENSION

HOLDS = ParameterSpec(
    "holds", "1", "1 where it may pull while it is compressed, 0 where not", 0.0, 1.0, default=0.0, free=False, null=0.0
)


class Maxwell(SpringLaw):
    """A spring in series with a dashpot (Maxwell): F = k (x - q) with q' = (x - q) / tau, and x = max(0, d - clearance).

    The memory q is the deformation of the dashpot: quick loading meets the slope k, and a force that is held falls by 63 % in
    tau. With `tension` it also pulls, and the clearance is free play either way; with `holds` it pulls back after it has
    relaxed, until the joint opens. In parallel with an elastic law it is the standard linear solid (Zener). A relaxation time
    below twice the step of the integration asks for a shorter step.
    """

    name = "maxwell"
    memory = "dashpot_deformation"
    parameters = (
        ParameterSpec("relaxing_stiffness", "N m-1", "slope of the spring (k)", lower=0.0, null=0.0),
        ParameterSpec("relaxation_time", "s", "in which a force that is held falls to 37 % (tau)", lower=2e-4, upper=1e3),
        CLEARANCE,
        TENSION,
        HOLDS,
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        dashpot_deformation: float,
        relaxing_stiffness: float,
        relaxation_time: float,
        clearance: float,
        tension: float,
        holds: float,
        engagement: float,
    ) -> float:
        """The force, N, compression positive."""
        engaged = _engaged(d, clearance, tension)
        spring = relaxing_stiffness * (engaged - dashpot_deformation)
        if tension > 0.0:
            return spring
        return max(0.0, spring) + holds * min(0.0, spring) * min(1.0, engaged / engagement)

    @staticmethod
    def memory_rate(
        d: float,
        ddot: float,
        d_max: float,
        dashpot_deformation: float,
        relaxing_stiffness: float,
        relaxation_time: float,
        clearance: float,
        tension: float,
        holds: float,
        engagement: float,
    ) -> float:
        """How fast the dashpot is deformed, m/s."""
        return (_engaged(d, clearance, tension) - dashpot_deformation) / relaxation_time


class QuasiLinear(SpringLaw):
    """Quasi-linear viscoelasticity with one relaxation time: F = F_a + s (F_a - q), q' = (F_a - q) / tau.

    F_a is the force of another law, `a ~ quasi_linear`, when it acts slowly; of each of its changes a share s more is felt at
    first, and fades. The memory q is the force as it was; where F_a has gone before it, the joint pulls back for a while with
    `holds`, and does nothing without. Alone it is a standard linear solid of 1 N/m. (Fung 1993,
    doi:10.1007/978-1-4757-2257-4)
    """

    name = "quasi_linear"
    memory = "faded_force"
    parameters = (
        ParameterSpec("fresh_share", "1", "share of a change of the force that fades (s)", lower=0.0, null=0.0),
        ParameterSpec("relaxation_time", "s", "in which 63 % of it fades (tau)", lower=2e-4, upper=1e3),
        HOLDS,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, faded_force: float, fresh_share: float, relaxation_time: float, holds: float
    ) -> float:
        """The force, N, compression positive; `d` is that of the other law."""
        total = d + fresh_share * (d - faded_force)
        return total if holds > 0.0 else max(0.0, total)

    @staticmethod
    def memory_rate(
        d: float, ddot: float, d_max: float, faded_force: float, fresh_share: float, relaxation_time: float, holds: float
    ) -> float:
        """How fast the memory follows the force, N/s."""
        return (d - faded_force) / relaxation_time


def _engaged(d: float, clearance: float, tension: float) -> float:
    """The deformation beyond the clearance."""
    pressed = max(0.0, d - clearance)
    return pressed + min(0.0, d + clearance) if tension > 0.0 else pressed
