"""Forces of a member's first crushing, to stand beside its plateau."""

import math

from crashkit.protocols import ParameterSpec, SpringLaw


class Peak(SpringLaw):
    """The peak of an undeformed member: P (u exp(1 - u))^n with u = d_max / peak_deformation.

    It depends on the largest deformation, so that it comes once; it is released along a slope of e n P / peak_deformation, the
    first slope of n = 1. It is about 2 / sqrt(n) times its deformation wide.
    """

    name = "peak"
    parameters = (
        ParameterSpec("peak_force", "N", "force above the plateau (P)", lower=0.0, null=0.0),
        ParameterSpec("peak_deformation", "m", "deformation at the peak", lower=1e-4),
        ParameterSpec(
            "peak_sharpness", "1", "1: dies out slowly; more: narrow (n)", lower=1.0, upper=200.0, default=1.0, null=1.0
        ),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, peak_force: float, peak_deformation: float, peak_sharpness: float) -> float:
        """The force, N, compression positive."""
        u = max(0.0, d_max) / peak_deformation
        release = math.e * peak_sharpness * (d_max - d) / peak_deformation
        return peak_force * max(0.0, (u * math.exp(1.0 - u)) ** peak_sharpness - release)


PLACE = (
    ParameterSpec("peak_force", "N", "force above the plateau (P)", lower=0.0, null=0.0),
    ParameterSpec("peak_deformation", "m", "deformation at the peak", lower=1e-4),
    ParameterSpec("peak_width", "m", "from the peak to where it ends, on the far side (w)", lower=1e-4),
)


class PointedPeak(SpringLaw):
    """The peak of an undeformed member, with a point: P (1 - |d_max - peak_deformation| / w), rising from 0 or later.

    The two sides may be of different widths. It comes once, like `peak`, and is released along the steeper of its flanks.
    """

    name = "pointed_peak"
    parameters = (
        *PLACE,
        ParameterSpec("peak_rise", "m", "the same on the near side; 0: as on the far side", lower=0.0, default=0.0),
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, peak_force: float, peak_deformation: float, peak_width: float, peak_rise: float
    ) -> float:
        """The force, N, compression positive."""
        rise = peak_rise if peak_rise > 0.0 else peak_width
        before = min(rise, peak_deformation)
        x = max(0.0, d_max) - peak_deformation
        share = 1.0 - max(x / peak_width, -x / before)
        return peak_force * max(0.0, max(0.0, share) - (d_max - d) / min(before, peak_width))


class BellPeak(SpringLaw):
    """The peak of an undeformed member, like a bell: P exp(-((d_max - peak_deformation) / w)^2), less what it has at 0.

    What it has at 0 is taken off along a line to the peak. It comes once, like `peak`, and is released along a
    slope of P / w, which is steeper than its flanks.
    """

    name = "bell_peak"
    parameters = (
        *PLACE[:2],
        ParameterSpec("peak_width", "m", "from the peak to where 37 % of it are left (w)", lower=1e-4),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, peak_force: float, peak_deformation: float, peak_width: float) -> float:
        """The force, N, compression positive."""
        x, u = max(0.0, d_max), peak_deformation / peak_width
        over = (x - peak_deformation) / peak_width
        share = math.exp(-(over * over)) - math.exp(-(u * u)) * max(0.0, 1.0 - x / peak_deformation)
        return peak_force * max(0.0, share - (d_max - d) / peak_width)


class ArchedPeak(SpringLaw):
    """The peak of an undeformed member, a half sine or a haversine: P sin(pi/2 (1 - |d_max - peak_deformation| / w))^p.

    Its near side is no wider than the way to the peak. It comes once, like `peak`, and is released along a slope of
    pi/2 P over the shorter of its sides, which is no less steep than its flanks.
    """

    name = "arched_peak"
    parameters = (
        *PLACE,
        ParameterSpec("peak_power", "1", "1: a half sine; 2: a haversine (p)", lower=1.0, upper=2.0, default=1.0),
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, peak_force: float, peak_deformation: float, peak_width: float, peak_power: float
    ) -> float:
        """The force, N, compression positive."""
        before = min(peak_width, peak_deformation)
        x = max(0.0, d_max) - peak_deformation
        share = math.sin(0.5 * math.pi * max(0.0, 1.0 - max(x / peak_width, -x / before))) ** peak_power
        return peak_force * max(0.0, share - 0.5 * math.pi * (d_max - d) / before)


class DecayingPeak(SpringLaw):
    """The peak of an undeformed member that is lost little by little: P exp(-(d_max - peak_deformation) / w) behind it.

    Before it, F rises in a line over `peak_rise`. It comes once, like `peak`, and is released along a slope of P over the
    shorter of the two ways, which is as steep as its flanks.
    """

    name = "decaying_peak"
    parameters = (
        *PLACE[:2],
        ParameterSpec("peak_width", "m", "from the peak to where 37 % of it are left (w)", lower=1e-4),
        ParameterSpec("peak_rise", "m", "from where it begins to the peak", lower=1e-4),
    )

    @staticmethod
    def force(
        d: float, ddot: float, d_max: float, peak_force: float, peak_deformation: float, peak_width: float, peak_rise: float
    ) -> float:
        """The force, N, compression positive."""
        before = min(peak_rise, peak_deformation)
        x = max(0.0, d_max) - peak_deformation
        if x < 0.0:
            share = 1.0 + x / before
        else:
            share = math.exp(-x / peak_width)
        return peak_force * max(0.0, max(0.0, share) - (d_max - d) / min(before, peak_width))


class DippingPeak(SpringLaw):
    """The peak of a member that buckles, and carries less than its plateau before it finds that again.

    F = P s(d_max): s rises like a quarter of a sine up to the peak, falls in a line to -dip in `peak_width` and comes back
    to 0 in `recovery`. It comes once, like `peak`, and is released to 0 along a slope of (pi / 2 + 1 + dip) P over the
    shortest of these ways, which is steeper than its flanks.
    """

    name = "dipping_peak"
    parameters = (
        *PLACE[:2],
        ParameterSpec("peak_width", "m", "from the peak to the dip (w)", lower=1e-4),
        ParameterSpec("dip", "1", "depth of the dip over the height of the peak", lower=0.0, upper=2.0),
        ParameterSpec("recovery", "m", "from the dip to the plateau", lower=1e-4),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        peak_force: float,
        peak_deformation: float,
        peak_width: float,
        dip: float,
        recovery: float,
    ) -> float:
        """The force, N, compression positive."""
        x = max(0.0, d_max)
        rising = math.sin(0.5 * math.pi * min(1.0, x / peak_deformation))
        beyond = max(0.0, x - peak_deformation)
        falling = (1.0 + dip) * min(1.0, beyond / peak_width)
        share = rising - falling + dip * min(1.0, max(0.0, beyond - peak_width) / recovery)
        release = (0.5 * math.pi + 1.0 + dip) * (d_max - d) / min(peak_deformation, peak_width, recovery)
        return peak_force * (max(0.0, max(0.0, share) - release) + min(0.0, min(0.0, share) + release))
