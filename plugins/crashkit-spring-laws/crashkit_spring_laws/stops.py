"""Forces that begin at a deformation, or end at one."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, ENGAGEMENT

STOP_DEFORMATION = ParameterSpec("stop_deformation", "m", "deformation at which the stop is met", lower=0.0)
STOP_EXPONENT = ParameterSpec("exponent", "1", "of the way beyond the stop (n)", lower=1.0, upper=4.0, default=1.5)
STOP_WAY = ParameterSpec("way", "m", "beyond the stop, at which `force` is meant", lower=1e-6, default=0.1, free=False)


class LinearStop(SpringLaw):
    """A stop that is met at a deformation: F = k max(0, d - stop_deformation)."""

    name = "linear_stop"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope beyond the stop (k)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, stiffness: float, stop_deformation: float) -> float:
        """The force, N, compression positive."""
        return stiffness * max(0.0, d - stop_deformation)


class QuadraticStop(SpringLaw):
    """A stop that stiffens: F = c max(0, d - stop_deformation)^2."""

    name = "quadratic_stop"
    parameters = (
        ParameterSpec("coefficient", "N m-2", "force for a unit of deformation squared (c)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, coefficient: float, stop_deformation: float) -> float:
        """The force, N, compression positive."""
        return coefficient * max(0.0, d - stop_deformation) ** 2


class PowerStop(SpringLaw):
    """A stop of any curvature: F = P (max(0, d - stop_deformation) / way)^n."""

    name = "power_stop"
    parameters = (
        ParameterSpec("force", "N", "force where the stop is pressed by `way` (P)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
        STOP_EXPONENT,
        STOP_WAY,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, force: float, stop_deformation: float, exponent: float, way: float
    ) -> float:
        """The force, N, compression positive."""
        pressed = max(0.0, d - stop_deformation) / way
        return force * pressed * max(pressed, 1e-12) ** (exponent - 1.0)  # 0^n has no derivative to n


class LockingStop(SpringLaw):
    """A stop that locks, as foam does: F = k x / (1 - min(x / locking_way, 0.95)), x = max(0, d - stop_deformation)."""

    name = "locking_stop"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope where the stop is met (k)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
        ParameterSpec("locking_way", "m", "way beyond the stop on which the force would grow without limit", lower=1e-5),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, stiffness: float, stop_deformation: float, locking_way: float) -> float:
        """The force, N, compression positive; a straight line where less than a twentieth of the way is left."""
        x = max(0.0, d - stop_deformation)
        return stiffness * x / (1.0 - min(x / locking_way, 0.95))


class ExponentialStop(SpringLaw):
    """A stop that stiffens without end: F = P (exp(x / growth_way) - 1), x = max(0, d - stop_deformation).

    Beyond ten growth ways it goes on in a straight line.
    """

    name = "exponential_stop"
    parameters = (
        ParameterSpec("force", "N", "by which the force has risen after 0.69 growth ways (P)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
        ParameterSpec("growth_way", "m", "way in which the slope grows by e", lower=1e-5),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, force: float, stop_deformation: float, growth_way: float) -> float:
        """The force, N, compression positive."""
        x = max(0.0, d - stop_deformation) / growth_way
        grown = math.exp(min(x, 10.0))
        return force * (grown - 1.0 + grown * max(0.0, x - 10.0))


class HuntCrossley(SpringLaw):
    """A contact with losses (Hunt and Crossley 1975, doi:10.1115/1.3423596): F = P u^n max(0, 1 + c ddot).

    u = max(0, d - stop_deformation) / way; n = 1.5 is Hertz's contact of a sphere.
    """

    name = "hunt_crossley"
    parameters = (
        ParameterSpec("force", "N", "force at rest where the stop is pressed by `way` (P)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
        STOP_EXPONENT,
        ParameterSpec("loss", "s m-1", "relative rise of the force with the rate (c)", lower=0.0, default=0.0, null=0.0),
        STOP_WAY,
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        force: float,
        stop_deformation: float,
        exponent: float,
        loss: float,
        way: float,
    ) -> float:
        """The force, N, compression positive."""
        pressed = d - stop_deformation
        if pressed <= 0.0:
            return 0.0
        return force * (pressed / way) ** exponent * max(0.0, 1.0 + loss * ddot)


class DampedStop(SpringLaw):
    """A stop with a dashpot that only pushes (Kelvin and Voigt): F = max(0, k x + c ddot min(1, x / engagement)).

    x = max(0, d - stop_deformation); it parts while it is still pressed, as the dashpot holds it back.
    """

    name = "damped_stop"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope beyond the stop (k)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
        ParameterSpec("damping", "N s m-1", "force for a unit of rate (c)", lower=0.0, default=0.0, null=0.0),
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, stiffness: float, stop_deformation: float, damping: float, engagement: float
    ) -> float:
        """The force, N, compression positive."""
        x = max(0.0, d - stop_deformation)
        return max(0.0, stiffness * x + damping * ddot * min(1.0, x / engagement))


class CrushStop(SpringLaw):
    """A stop that is crushed: F = k max(0, min(x_max, crush_length) - release (x_max - x)), x = max(0, d - stop_deformation).

    It keeps what it has taken up: beyond crush_length its force rises no further, and it lets go along a steeper slope.
    """

    name = "crush_stop"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope beyond the stop (k)", lower=0.0, null=0.0),
        STOP_DEFORMATION,
        ParameterSpec("crush_length", "m", "way beyond the stop after which the force stays", lower=1e-5),
        ParameterSpec("release", "1", "slope on the way back, relative to k", lower=1.0, upper=1e3),
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, stiffness: float, stop_deformation: float, crush_length: float, release: float
    ) -> float:
        """The force, N, compression positive."""
        x, x_max = max(0.0, d - stop_deformation), max(0.0, d_max - stop_deformation)
        return stiffness * max(0.0, min(x_max, crush_length) - release * (x_max - x))


class Pad(SpringLaw):
    """A soft pad that fills a gap and is then pressed flat: F = P min(1, d / clearance)^n, nothing where there is no gap.

    Beside a law with the same clearance, `a | pad`, what the member feels before it engages.
    """

    name = "pad"
    parameters = (
        ParameterSpec("pad_force", "N", "force of the pad that is pressed flat (P)", lower=0.0, null=0.0),
        ParameterSpec("pad_exponent", "1", "of the way into the pad (n)", lower=0.3, upper=6.0, default=1.0),
        CLEARANCE,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, pad_force: float, pad_exponent: float, clearance: float) -> float:
        """The force, N, compression positive."""
        if d <= 0.0 or clearance <= 0.0:
            return 0.0
        return pad_force * min(1.0, d / clearance) ** pad_exponent


class TensionSpring(SpringLaw):
    """A spring that only pulls, once its slack is gone: F = k min(0, d + slack)."""

    name = "tension_spring"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "slope in tension (k)", lower=0.0, null=0.0),
        ParameterSpec("slack", "m", "extension before it pulls", lower=0.0, default=0.0, null=0.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, stiffness: float, slack: float) -> float:
        """The force, N, compression positive."""
        return stiffness * min(0.0, d + slack)


class YieldingStrap(SpringLaw):
    """A strap that only pulls, and yields: F = -k x / (1 + (k x / L)^n)^(1/n), x = max(0, -d - slack)."""

    name = "yielding_strap"
    parameters = (
        ParameterSpec("stiffness", "N m-1", "first slope in tension (k)", lower=0.0, null=0.0),
        ParameterSpec("slack", "m", "extension before it pulls", lower=0.0, default=0.0),
        ParameterSpec("yield_force", "N", "force towards which it bends (L)", lower=1e-3),
        ParameterSpec("corner", "1", "1: it bends at once; more: it bends late and sharply (n)", 1.0, 20.0, default=2.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, stiffness: float, slack: float, yield_force: float, corner: float) -> float:
        """The force, N, compression positive."""
        straight = stiffness * min(0.0, d + slack)
        share = max(-straight / yield_force, 1e-12)  # 0^n has no derivative to n
        return straight / (1.0 + share**corner) ** (1.0 / corner)


class Hook(SpringLaw):
    """A hook that latches where its member was crushed to, and pulls on the way back.

    F = -P (max(0, d_max - d - play) / way)^n, at most `pull_limit`
    """

    name = "hook"
    parameters = (
        ParameterSpec("pull_force", "N", "force of the hook stretched by `way` beyond its play (P)", lower=0.0, null=0.0),
        ParameterSpec("play", "m", "way back before it pulls", lower=0.0, default=0.0),
        ParameterSpec("pull_exponent", "1", "of the way beyond the play (n)", lower=1.0, upper=4.0, default=1.0),
        ParameterSpec("way", "m", "beyond the play, at which `pull_force` is meant", lower=1e-6, default=0.01, free=False),
        ParameterSpec("pull_limit", "N", "at which it yields; omitted (0): never", lower=0.0, default=0.0, null=0.0),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        pull_force: float,
        play: float,
        pull_exponent: float,
        way: float,
        pull_limit: float,
    ) -> float:
        """The force, N, compression positive."""
        stretched = d_max - d - play
        if stretched <= 0.0:
            return 0.0
        pull = pull_force * (stretched / way) ** pull_exponent
        if pull_limit > 0.0:
            pull = min(pull, pull_limit)
        return -pull
