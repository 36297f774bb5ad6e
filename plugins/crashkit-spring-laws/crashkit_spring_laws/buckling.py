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


class Folding(SpringLaw):
    """Folds that form one after another: A sin(2 pi x / fold_length) with x = d_max - onset, 0 before the onset.

    It depends on the largest deformation, and is released to 0 along the steepest slope of a fold, 2 pi A / fold_length.
    """

    name = "folding"
    parameters = (
        ParameterSpec("amplitude", "N", "force above and below the plateau (A)", lower=0.0, null=0.0),
        ParameterSpec("fold_length", "m", "deformation from fold to fold", lower=1e-3),
        ParameterSpec("onset", "m", "deformation at which the first fold begins", lower=0.0, default=0.0),
    )

    @staticmethod
    def force(d: float, ddot: float, d_max: float, amplitude: float, fold_length: float, onset: float) -> float:
        """The force, N, compression positive."""
        wave_number = 2.0 * math.pi / fold_length
        crest = math.sin(wave_number * max(0.0, d_max - onset))
        release = wave_number * (d_max - d)
        return amplitude * (max(0.0, crest - release) + min(0.0, crest + release))
