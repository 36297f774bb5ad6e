"""Dry friction: forces that oppose the rate, whatever its size."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, ENGAGEMENT

FRICTION_FORCE = ParameterSpec("friction_force", "N", "force while sliding", lower=0.0, null=0.0)
SLIP_RATE = ParameterSpec("slip_rate", "m s-1", "rate at which sliding is established", lower=1e-3, default=0.05, free=False)
STICK = ParameterSpec("stick", "1", "relative rise of the force at low rates", lower=-0.9, upper=9.0, default=0.0, null=0.0)
STICK_RATE = ParameterSpec("stick_rate", "m s-1", "rate above which that is lost", lower=1e-2, default=1.0, free=False)
ALWAYS = ParameterSpec(
    "always",
    "1",
    "1 where it acts at all times, 0 where only while the joint is compressed",
    lower=0.0,
    upper=1.0,
    default=1.0,
    free=False,
)


class Coulomb(SpringLaw):
    """Dry friction: F = friction_force s(ddot / slip_rate) (1 + stick exp(-(ddot / stick_rate)^2)) g(d).

    On the way back (ddot < 0) it is `rebound` times as much, as of wedges, which grip in one direction.
    s(x) = (1 - tail) tanh x + tail 2/pi atan(pi x / 2);  g = max(always, min(1, max(0, d - clearance) / engagement)).
    With `stick` it falls with the rate (Stribeck); with `tail` it is long in reaching its full force. Smooth, because a force
    that jumps with the sign of the rate would hold the joint on its jump. So what should stick creeps, by at most slip_rate;
    friction that sticks is `dahl`.
    """

    name = "coulomb"
    parameters = (
        FRICTION_FORCE,
        SLIP_RATE,
        ALWAYS,
        ENGAGEMENT,
        STICK,
        STICK_RATE,
        CLEARANCE,
        ParameterSpec("tail", "1", "0: reached like a tanh, 1: like an atan", lower=-0.5, upper=2.5, default=0.0, null=0.0),
        ParameterSpec("rebound", "1", "on the way back, relative to that on the way in", 0.0, 10.0, default=1.0, null=1.0),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        friction_force: float,
        slip_rate: float,
        always: float,
        engagement: float,
        stick: float,
        stick_rate: float,
        clearance: float,
        tail: float,
        rebound: float,
    ) -> float:
        """The force, N, compression positive."""
        slip = ddot / slip_rate
        share = (1.0 - tail) * math.tanh(slip) + tail * math.atan(0.5 * math.pi * slip) / (0.5 * math.pi)
        level = 1.0 + stick * math.exp(-((ddot / stick_rate) ** 2))
        if ddot < 0.0:
            level = level * rebound
        return friction_force * share * level * max(always, min(1.0, max(0.0, d - clearance) / engagement))


class Brake(SpringLaw):
    """A brake that is put on at a time: F = friction_force tanh(ddot / slip_rate) min(1, max(0, m - start) / rise), m' = 1.

    The memory m is the time since t = 0.
    """

    name = "brake"
    memory = "time_passed"
    parameters = (
        FRICTION_FORCE,
        SLIP_RATE,
        ParameterSpec("start", "s", "when it begins to brake", lower=0.0),
        ParameterSpec("rise", "s", "from there until it brakes fully", lower=1e-4),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        time_passed: float,
        friction_force: float,
        slip_rate: float,
        start: float,
        rise: float,
    ) -> float:
        """The force, N, compression positive."""
        return friction_force * math.tanh(ddot / slip_rate) * min(1.0, max(0.0, time_passed - start) / rise)

    @staticmethod
    def memory_rate(
        d: float,
        ddot: float,
        d_max: float,
        time_passed: float,
        friction_force: float,
        slip_rate: float,
        start: float,
        rise: float,
    ) -> float:
        """How fast time passes, 1."""
        return 1.0


class Rubbing(SpringLaw):
    """Dry friction that the joint's own force presses.

    1 + share tanh(ddot / slip_rate) (1 + stick exp(-(ddot / stick_rate)^2))

    So a sleeve, a clamp or a wrapped belt gives back less than it took: of its force F the share rubs, whatever F is.
    """

    name = "rubbing"
    unit = "1"
    parameters = (
        ParameterSpec("friction_share", "1", "friction over the joint's force (share)", lower=0.0, upper=1.0, null=0.0),
        SLIP_RATE,
        STICK,
        STICK_RATE,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, friction_share: float, slip_rate: float, stick: float, stick_rate: float
    ) -> float:
        """The factor."""
        level = 1.0 + stick * math.exp(-((ddot / stick_rate) ** 2))
        return 1.0 + friction_share * math.tanh(ddot / slip_rate) * level


class RubbingGap(SpringLaw):
    """Dry friction in a gap: F = f tanh(ddot / slip_rate) (1 - min(1, max(0, d - clearance) / engagement)).

    Beside a law with the same clearance, `a | rubbing_gap`, what the member feels before it engages; nothing where there is no
    gap.
    """

    name = "rubbing_gap"
    parameters = (
        FRICTION_FORCE,
        SLIP_RATE,
        CLEARANCE,
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, friction_force: float, slip_rate: float, clearance: float, engagement: float
    ) -> float:
        """The force, N, compression positive."""
        if clearance <= 0.0:
            return 0.0
        loose = 1.0 - min(1.0, max(0.0, d - clearance) / engagement)
        return friction_force * math.tanh(ddot / slip_rate) * loose


class Dahl(SpringLaw):
    """Dry friction of bristles that bend before they slip (Dahl 1976, doi:10.2514/3.61511).

    F = friction_force z max(always, min(1, max(0, d) / engagement)), z' = ddot / bristle_length (1 - z sign(ddot))

    The memory z, from -1 to 1, is the share of the force that is reached: 63 % of what is missing after one bristle length in
    either direction. It sticks: at rest it holds what it holds.
    """

    name = "dahl"
    memory = "bristle"
    parameters = (
        FRICTION_FORCE,
        ParameterSpec("bristle_length", "m", "way on which the force turns round", lower=1e-5),
        ALWAYS,
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        bristle: float,
        friction_force: float,
        bristle_length: float,
        always: float,
        engagement: float,
    ) -> float:
        """The force, N, compression positive."""
        return friction_force * bristle * max(always, min(1.0, max(0.0, d) / engagement))

    @staticmethod
    def memory_rate(
        d: float,
        ddot: float,
        d_max: float,
        bristle: float,
        friction_force: float,
        bristle_length: float,
        always: float,
        engagement: float,
    ) -> float:
        """How fast the bristles bend, 1/s."""
        return (ddot - bristle * abs(ddot)) / bristle_length
