"""Force that is lost little by little: with deformation, for good, on the way back, or with the time under load."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw

LOSS = ParameterSpec("loss", "1", "share of the force that is lost in the end", lower=0.0, upper=1.0, null=0.0)


class Softening(SpringLaw):
    """A member that tears open as it is crushed: 1 - loss min(1, max(0, d_max - softening_deformation) / softening_length)."""

    name = "softening"
    unit = "1"
    parameters = (
        ParameterSpec("softening_deformation", "m", "largest deformation that is borne whole", lower=0.0),
        ParameterSpec("softening_length", "m", "further deformation over which the share is lost", lower=1e-4),
        LOSS,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, softening_deformation: float, softening_length: float, loss: float
    ) -> float:
        """The factor."""
        return 1.0 - loss * min(1.0, max(0.0, d_max - softening_deformation) / softening_length)


class SmoothSoftening(SpringLaw):
    """A member that tears open smoothly: 1 - loss (1 + tanh((d_max - softening_middle) / softening_spread)) / 2."""

    name = "smooth_softening"
    unit = "1"
    parameters = (
        ParameterSpec("softening_middle", "m", "largest deformation at which half of the share is lost", lower=0.0),
        ParameterSpec("softening_spread", "m", "further deformation in which 76 % of the rest is lost", lower=1e-4),
        LOSS,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, softening_middle: float, softening_spread: float, loss: float) -> float:
        """The factor."""
        return 1.0 - 0.5 * loss * (1.0 + math.tanh((d_max - softening_middle) / softening_spread))


class LostForce(SpringLaw):
    """What a loading curve loses where it tears: F = -L min(1, max(0, d_max - softening_deformation) / softening_length).

    In the curve of another law, `a + lost_force`, it leaves the slope of unloading as it is, which `softening` does not. In a
    joint of its own it is let go over `softening_length` of the way back.
    """

    name = "lost_force"
    passive = False  # alone it pulls where it is deformed further
    parameters = (
        ParameterSpec("lost_force", "N", "force that is lost in the end (L)", lower=0.0, null=0.0),
        ParameterSpec("softening_deformation", "m", "largest deformation that is borne whole", lower=0.0),
        ParameterSpec("softening_length", "m", "further deformation over which it is lost", lower=1e-4),
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, lost_force: float, softening_deformation: float, softening_length: float
    ) -> float:
        """The force, N, compression positive."""
        torn = min(1.0, max(0.0, d_max - softening_deformation) / softening_length)
        return -lost_force * max(0.0, torn - (d_max - d) / softening_length)


class StepwiseSoftening(SpringLaw):
    """A member that tears open in two steps: 1 - loss r(d_max - e) - second_loss r(d_max - e - step_way).

    Here e is `softening_deformation`, and r(x) = min(1, max(0, x) / softening_length); more than all is never lost.
    """

    name = "stepwise_softening"
    unit = "1"
    parameters = (
        ParameterSpec("softening_deformation", "m", "largest deformation that is borne whole", lower=0.0),
        ParameterSpec("softening_length", "m", "further deformation of each step", lower=1e-4),
        ParameterSpec("loss", "1", "share of the force that is lost in the first step", lower=0.0, upper=1.0, null=0.0),
        ParameterSpec("step_way", "m", "deformation from the first step to the second", lower=0.0),
        ParameterSpec("second_loss", "1", "share that is lost in the second step", lower=0.0, upper=1.0, null=0.0),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        softening_deformation: float,
        softening_length: float,
        loss: float,
        step_way: float,
        second_loss: float,
    ) -> float:
        """The factor."""
        first = min(1.0, max(0.0, d_max - softening_deformation) / softening_length)
        second = min(1.0, max(0.0, d_max - softening_deformation - step_way) / softening_length)
        return max(0.0, 1.0 - loss * first - second_loss * second)


class DelayedSoftening(SpringLaw):
    """A member that tears open in time: 1 - loss (1 - exp(-k s)) / (1 - exp(-k)), s = min(1, max(0, m - delay) / duration).

    The memory m is the time since d_max passed `softening_deformation`, as of a crack that runs, or a weld that opens. It
    tears evenly for small k, and for large k the faster the more is left to tear.
    """

    name = "delayed_softening"
    unit = "1"
    memory = "time_since"
    jumps = True
    parameters = (
        ParameterSpec("softening_deformation", "m", "largest deformation that is borne whole", lower=1e-4),
        LOSS,
        ParameterSpec("delay", "s", "from there until it begins to tear", lower=0.0),
        ParameterSpec("duration", "s", "of the tearing", lower=1e-4),
        ParameterSpec("slowing", "1", "how it slows down, ln of its first rate over its last (k)", 0.01, 20.0, default=0.01),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        time_since: float,
        softening_deformation: float,
        loss: float,
        delay: float,
        duration: float,
        slowing: float,
    ) -> float:
        """The factor."""
        passed = min(1.0, max(0.0, time_since - delay) / duration)
        return 1.0 - loss * (1.0 - math.exp(-slowing * passed)) / (1.0 - math.exp(-slowing))

    @staticmethod
    def memory_rate(
        d: float,
        ddot: float,
        d_max: float,
        time_since: float,
        softening_deformation: float,
        loss: float,
        delay: float,
        duration: float,
        slowing: float,
    ) -> float:
        """How fast time passes, 1, once it has been deformed so far."""
        return 1.0 if d_max > softening_deformation else 0.0


class UnloadingLoss(SpringLaw):
    """A member that gives back less than it took: 1 - loss (1 - exp(-(d_max - d) / unloading_length))."""

    name = "unloading_loss"
    unit = "1"
    parameters = (
        LOSS,
        ParameterSpec("unloading_length", "m", "way back over which 63 % of the share is lost", lower=1e-6),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, loss: float, unloading_length: float) -> float:
        """The factor."""
        return 1.0 - loss * (1.0 - math.exp(-(d_max - d) / unloading_length))


class ResidualSet(SpringLaw):
    """A member that stays crushed: 1 - loss (1 - x^n), x = max(0, (d - s d_max) / ((1 - s) d_max)).

    With a loss of 1 it comes back no further than to a share s of its largest deformation, whatever that was.
    """

    name = "residual_set"
    unit = "1"
    parameters = (
        LOSS,
        ParameterSpec("residual_share", "1", "share of the largest deformation that stays (s)", lower=0.0, upper=0.99),
        ParameterSpec("unloading_exponent", "1", "how the force falls on the way back (n)", lower=1.0, upper=10.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, loss: float, residual_share: float, unloading_exponent: float) -> float:
        """The factor."""
        x = 1.0 - (d_max - d) / ((1.0 - residual_share) * max(d_max, 1e-6))
        if x <= 0.0:
            return 1.0 - loss
        return 1.0 - loss * (1.0 - x**unloading_exponent)


class PlasticShare(SpringLaw):
    """The share of a joint that stays crushed, of which the rest is elastic: "crush_plateau % plastic_share"."""

    name = "plastic_share"
    unit = "1"
    parameters = (
        ParameterSpec("plastic_share", "1", "share of the joint that stays crushed", lower=0.0, upper=1.0, null=1.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, plastic_share: float) -> float:
        """The share."""
        return plastic_share


class SecondLine(SpringLaw):
    """Where a member turns to unloading less steeply, and how much less: "crush_plateau / second_line".

    The second line begins at the share c of the force from which the first came, with r times its slope. Drawn back to where
    the first began, it holds a share s = c + (1 - c) r of that force.
    """

    name = "second_line"
    unit = "1"
    parameters = (
        ParameterSpec("turning_share", "1", "share of the force at which the second line begins (c)", lower=0.0, upper=1.0),
        ParameterSpec("slope_ratio", "1", "slope of the second line over the first (r)", lower=1e-3, upper=1.0, null=1.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, turning_share: float, slope_ratio: float) -> float:
        """The share s."""
        return turning_share + (1.0 - turning_share) * slope_ratio


class Fading(SpringLaw):
    """A force of which a share fades under load: 1 - fading_share m, with m' = (1 - m) / tau while d > 0, and -m / tau else.

    The memory m goes from 0 to 1 as the joint stays compressed, and back as it rests. Where the law's force sets in at once
    and stays, this is quasi-linear viscoelasticity with one relaxation time (Fung 1993, doi:10.1007/978-1-4757-2257-4).
    """

    name = "fading"
    unit = "1"
    memory = "faded"
    jumps = True
    parameters = (
        ParameterSpec("fading_share", "1", "share of the force that fades", lower=0.0, upper=1.0, null=0.0),
        ParameterSpec("relaxation_time", "s", "in which 63 % of the share is lost (tau)", lower=2e-4, upper=1e3),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, faded: float, fading_share: float, relaxation_time: float) -> float:
        """The factor."""
        return 1.0 - fading_share * faded

    @staticmethod
    def memory_rate(d: float, ddot: float, d_max: float, faded: float, fading_share: float, relaxation_time: float) -> float:
        """How fast it fades, 1/s."""
        return ((1.0 if d > 0.0 else 0.0) - faded) / relaxation_time
