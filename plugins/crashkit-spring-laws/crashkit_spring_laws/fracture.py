"""Loss of force for good."""

from crashkit.protocols import ParameterSpec, SpringLaw

LOSS = ParameterSpec("loss", "1", "share of the force that is lost", lower=0.0, upper=1.0, null=0.0)
FRACTURE_DEFORMATION = ParameterSpec("fracture_deformation", "m", "largest deformation that is borne", lower=1e-4)


class Fracture(SpringLaw):
    """A member that breaks in compression: 1, and 1 - loss for good once d_max passes fracture_deformation."""

    name = "fracture"
    unit = "1"
    jumps = True
    parameters = (FRACTURE_DEFORMATION, LOSS)

    @staticmethod
    def force(d: float, ddot: float, d_max: float, fracture_deformation: float, loss: float) -> float:
        """The factor."""
        return 1.0 - loss if d_max > fracture_deformation else 1.0


class Brittle(SpringLaw):
    """A strut that breaks: F = k max(0, d), and (1 - loss) of it for good once d_max passes fracture_deformation."""

    name = "brittle"
    jumps = True
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope of the sound strut (k)", lower=0.0, null=0.0),
        FRACTURE_DEFORMATION,
        ParameterSpec("loss", "1", "share of the force that is lost", lower=0.0, upper=1.0, default=1.0, free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, stiffness: float, fracture_deformation: float, loss: float) -> float:
        """The force, N, compression positive."""
        sound = stiffness * max(0.0, d)
        return (1.0 - loss) * sound if d_max > fracture_deformation else sound


class Tear(SpringLaw):
    """A member that tears in tension: 1 - loss min(1, D), where the damage D grows by 1 / duration while -d > tear_extension.

    The memory D never heals. So the share `loss` of the force is gone for good after `duration` beyond the extension.
    """

    name = "tear"
    unit = "1"
    memory = "damage"
    jumps = True
    parameters = (
        ParameterSpec("tear_extension", "m", "extension beyond which it tears", lower=1e-4),
        LOSS,
        ParameterSpec("duration", "s", "of the tearing", lower=1e-5, default=5e-4, free=False),
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, damage: float, tear_extension: float, loss: float, duration: float
    ) -> float:
        """The factor."""
        return 1.0 - loss * min(1.0, damage)

    @staticmethod
    def memory_rate(
        d: float, ddot: float, d_max: float, damage: float, tear_extension: float, loss: float, duration: float
    ) -> float:
        """How fast the damage grows, 1/s."""
        return 1.0 / duration if -d > tear_extension else 0.0
