"""Forces estimated from data: a sum of bumps, with no assumption on the shape."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import ENGAGEMENT

HEIGHTS = ParameterSpec("heights", "N", "heights of the bumps, of either sign", vector=True, null=0.0)
UNLOADING_LENGTH = ParameterSpec(
    "unloading_length",
    "m",
    "way back over which the force is lost; omitted (0): unloads along the loading curve",
    lower=1e-6,
    default=0.0,
    null=0.0,
)
WIDTH = 0.8
"""Of a bump, in distances between bumps: wide enough to overlap smoothly, narrow enough to be told apart."""

ROUNDED = 0.02
"""Of the reach: over so much of it the table of another joint's deformation comes to its end."""


class SmoothTable(SpringLaw):
    """A smooth force of the deformation: bumps at even distances between d = 0 and d = reach.

    F = min(1, max(0, d) / engagement) sum_i heights[i] exp(-((n d / reach - i - 1/2) / 0.8)^2), beyond reach as at reach.
    With an unloading length, F = F(d_max) max(0, 1 - (d_max - d) / unloading_length).
    """

    name = "smooth_table"
    passive = False
    parameters = (
        HEIGHTS,
        ParameterSpec("reach", "m", "deformation that the bumps cover", lower=1e-6, free=False),
        UNLOADING_LENGTH,
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, heights: list[float], reach: float, unloading_length: float, engagement: float
    ) -> float:
        """The force, N, compression positive."""
        turn = d_max if unloading_length > 0.0 else d
        place = min(turn / reach, 1.0) * len(heights)
        total = 0.0
        for i, height in enumerate(heights):
            total = total + height * math.exp(-(((place - i - 0.5) / WIDTH) ** 2))
        total = total * min(1.0, max(0.0, turn) / engagement)
        if turn > d:
            total = total * max(0.0, 1.0 - (turn - d) / unloading_length)
        return total


class Bump(SpringLaw):
    """A force of either sign about one deformation: F = min(1, max(0, d) / engagement) B exp(-((d - bump_deformation) / w)^2).

    It comes back along the way that it came, unless it stands in a law that loses its force.
    """

    name = "bump"
    passive = False
    parameters = (
        ParameterSpec("bump_force", "N", "at its largest, of either sign (B)", null=0.0),
        ParameterSpec("bump_deformation", "m", "where it is largest", lower=1e-4),
        ParameterSpec("bump_width", "m", "from there to where 37 % of it are left (w)", lower=1e-4),
        ENGAGEMENT,
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, bump_force: float, bump_deformation: float, bump_width: float, engagement: float
    ) -> float:
        """The force, N, compression positive."""
        over = (d - bump_deformation) / bump_width
        return bump_force * math.exp(-(over * over)) * min(1.0, max(0.0, d) / engagement)


class RateTable(SpringLaw):
    """A smooth force of the rate while in contact: bumps at even distances between -reach and reach.

    F = min(1, max(0, d) / engagement) sum_i heights[i] exp(-((n (ddot / reach + 1) / 2 - i - 1/2) / 0.8)^2), beyond -reach and
    reach as there.
    """

    name = "rate_table"
    passive = False
    parameters = (
        HEIGHTS,
        ParameterSpec("reach", "m s-1", "rate that the bumps cover, either way", lower=1e-6, free=False),
        ENGAGEMENT,
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, heights: list[float], reach: float, engagement: float) -> float:
        """The force, N, compression positive."""
        place = min(max(ddot / reach + 1.0, 0.0) / 2.0, 1.0) * len(heights)
        total = 0.0
        for i, height in enumerate(heights):
            total = total + height * math.exp(-(((place - i - 0.5) / WIDTH) ** 2))
        return total * min(1.0, max(0.0, d) / engagement)


class TimeTable(SpringLaw):
    """A smooth force of the time alone, in contact or not: bumps at even distances over the duration of a run.

    F = sum_i heights[i] exp(-((n t / duration - i - 1/2) / 0.8)^2), beyond the duration as at its end.
    """

    name = "time_table"
    memory = "time_passed"
    passive = False
    parameters = (
        HEIGHTS,
        ParameterSpec("duration", "s", "time that the bumps cover", lower=1e-6, free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, time_passed: float, heights: list[float], duration: float) -> float:
        """The force, N, compression positive."""
        place = min(max(0.0, time_passed) / duration, 1.0) * len(heights)
        total = 0.0
        for i, height in enumerate(heights):
            total = total + height * math.exp(-(((place - i - 0.5) / WIDTH) ** 2))
        return total

    @staticmethod
    def memory_rate(d: float, ddot: float, d_max: float, time_passed: float, heights: list[float], duration: float) -> float:
        """How fast time passes, 1."""
        return 1.0


class Pulse(SpringLaw):
    """A force of the time alone that comes and goes once, in contact or not: F = B exp(-((t - pulse_time) / w)^2).

    w is `rise_time` before it is largest and `fall_time` from there on.
    """

    name = "pulse"
    memory = "time_passed"
    passive = False
    parameters = (
        ParameterSpec("pulse_force", "N", "at its largest, of either sign (B)", null=0.0),
        ParameterSpec("pulse_time", "s", "when it is largest", lower=0.0),
        ParameterSpec("rise_time", "s", "before that, since 37 % of it were reached", lower=1e-5),
        ParameterSpec("fall_time", "s", "after that, until 37 % of it are left", lower=1e-5),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        time_passed: float,
        pulse_force: float,
        pulse_time: float,
        rise_time: float,
        fall_time: float,
    ) -> float:
        """The force, N, compression positive."""
        since = time_passed - pulse_time
        over = since / fall_time if since > 0.0 else since / rise_time
        return pulse_force * math.exp(-(over * over))

    @staticmethod
    def memory_rate(
        d: float,
        ddot: float,
        d_max: float,
        time_passed: float,
        pulse_force: float,
        pulse_time: float,
        rise_time: float,
        fall_time: float,
    ) -> float:
        """How fast time passes, 1."""
        return 1.0


class RateCurve(SpringLaw):
    """A smooth factor of the rate: 1 + bumps at even distances between -rate_reach and rate_reach.

    1 + sum_i rate_heights[i] exp(-((n (ddot / rate_reach + 1) / 2 - i - 1/2) / 0.8)^2), beyond -rate_reach and rate_reach as
    there, and never below 0.
    """

    name = "rate_curve"
    unit = "1"
    passive = False
    parameters = (
        ParameterSpec("rate_heights", "1", "relative heights of the bumps, of either sign", vector=True, null=0.0),
        ParameterSpec("rate_reach", "m s-1", "rate that the bumps cover, either way", lower=1e-6, free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, rate_heights: list[float], rate_reach: float) -> float:
        """The factor."""
        place = min(max(ddot / rate_reach + 1.0, 0.0) / 2.0, 1.0) * len(rate_heights)
        total = 1.0
        for i, height in enumerate(rate_heights):
            total = total + height * math.exp(-(((place - i - 0.5) / WIDTH) ** 2))
        return max(0.0, total)


class DrivenCurve(SpringLaw):
    """A smooth factor of another joint's deformation: 1 + bumps at even distances between d = 0 and d = driver_reach.

    1 + sum_i driver_heights[i] exp(-((n u - i - 1/2) / 0.8)^2), u = (s + 1 - sqrt((s - 1)^2 + 0.02^2)) / 2,
    s = d / driver_reach; beyond driver_reach about as there.
    """

    name = "driven_curve"
    unit = "1"
    passive = False
    driven = True
    parameters = (
        ParameterSpec("driver_heights", "1", "relative heights of the bumps, of either sign", vector=True, null=0.0),
        ParameterSpec("driver_reach", "m", "deformation of the driving joint that the bumps cover", lower=1e-6, free=False),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, driver_heights: list[float], driver_reach: float) -> float:
        """The factor."""
        share = d / driver_reach
        place = 0.5 * (share + 1.0 - math.sqrt((share - 1.0) ** 2 + ROUNDED**2)) * len(driver_heights)
        total = 1.0
        for i, height in enumerate(driver_heights):
            total = total + height * math.exp(-(((place - i - 0.5) / WIDTH) ** 2))
        return total
