"""Smoothers: values and derivatives from noisy samples."""

from crashkit_smoothers.adaptive_quintic import AdaptiveQuintic
from crashkit_smoothers.gcv_splines import GcvCubic, GcvHeptic, GcvQuintic
from crashkit_smoothers.spectral import Spectral

__all__ = ["AdaptiveQuintic", "GcvCubic", "GcvHeptic", "GcvQuintic", "Spectral"]
