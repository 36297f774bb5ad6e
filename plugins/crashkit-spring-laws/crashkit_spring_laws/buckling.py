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


class Folding(SpringLaw):
    """Folds that form one after another: A exp(-weakening t) asin(s sqrt p) / asin(sqrt p), 0 before the onset.

    With the skew k, v = w + arch (cos w - 1) and s = atan(k sin v / (1 - k cos v)) / asin k: a sine for k = 0, and near 1 a
    saw, the sum of k^n sin(n v) / n. With the pointedness p near 1 a sine becomes a triangle; below 0, where the same series
    is asinh(s sqrt(-p)) / asinh(sqrt(-p)), it is blunt; for p = 0 a fold is s. There t = max(0, d_max - onset) / fold_length
    and w = 2 pi t (1 + shortening t). Folds that get longer, g = -2 shortening > 0, have w = 2 pi ln(1 + g t) / g, and a
    height lower by 1 + g t, so that each takes up as much. It depends on the largest deformation, and is released to 0 along
    a slope that no fold exceeds, A exp(-weakening t) (K (1 + arch) dw + (weakening + g) dt) / dd_max with K = |k| /
    (1 - |k|) / asin |k|, times sqrt(-p) / asinh(sqrt(-p)) where they are blunt.
    """

    name = "folding"
    parameters = (
        ParameterSpec("amplitude", "N", "force above and below the plateau (A)", lower=0.0, null=0.0),
        ParameterSpec("fold_length", "m", "deformation from fold to fold", lower=1e-3),
        ParameterSpec("onset", "m", "deformation at which the first fold begins", lower=0.0, default=0.0),
        ParameterSpec("skew", "1", "of a fold: above 0 it rises faster than it falls", -0.98, 0.98, default=0.0, null=0.0),
        ParameterSpec(
            "arch", "1", "of a fold: above 0 its crests are wide, its troughs narrow", 0.0, 0.95, default=0.0, null=0.0
        ),
        ParameterSpec(
            "shortening", "1", "of the folds: by which each is shorter, below 0 longer", -0.5, 0.5, default=0.0, null=0.0
        ),
        ParameterSpec(
            "weakening", "1", "of the folds: by which each is lower, as a logarithm", 0.0, 3.0, default=0.0, null=0.0
        ),
        ParameterSpec(
            "pointedness", "1", "of a fold: near 1 a triangle, below 0 blunt (p)", -50.0, 0.99, default=0.0, null=0.0
        ),
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        amplitude: float,
        fold_length: float,
        onset: float,
        skew: float,
        arch: float,
        shortening: float,
        weakening: float,
        pointedness: float,
    ) -> float:
        """The force, N, compression positive."""
        turns = max(0.0, d_max - onset) / fold_length
        longer = max(0.0, -2.0 * shortening)
        if longer > 0.0:
            folds = math.log(1.0 + longer * turns) / longer
        else:
            folds = turns * (1.0 + shortening * turns)
        phase = 2.0 * math.pi * folds + arch * (math.cos(2.0 * math.pi * folds) - 1.0)
        if skew * skew > 1e-12:
            crest = math.atan(skew * math.sin(phase) / (1.0 - skew * math.cos(phase))) / math.asin(skew)
            steepest = skew / (1.0 - max(skew, -skew)) / math.asin(skew)
        else:
            crest = math.sin(phase)
            steepest = 1.0
        if pointedness > 1e-12:
            root = math.sqrt(pointedness)
            crest = math.asin(root * crest) / math.asin(root)
        elif pointedness < -1e-12:
            root = math.sqrt(-pointedness)
            whole = math.log(root + math.sqrt(root * root + 1.0))
            crest = math.log(root * crest + math.sqrt(root * root * crest * crest + 1.0)) / whole
            steepest = steepest * root / whole
        steepest = steepest * (1.0 + arch) * (1.0 + 2.0 * max(0.0, shortening) * turns)
        release = (2.0 * math.pi * steepest + weakening + longer) / fold_length * (d_max - d)
        height = amplitude * math.exp(-weakening * turns) / (1.0 + longer * turns)
        return height * (max(0.0, crest - release) + min(0.0, crest + release))
