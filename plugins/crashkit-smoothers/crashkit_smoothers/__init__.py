"""Smoothers: values and derivatives from noisy samples."""

from crashkit_smoothers.gcv_quintic import GcvQuintic

__all__ = ["GcvQuintic"]
