"""Smoothing and differentiation: crash pulses with known derivatives, beside scipy, csaps, pynumdiff and the best possible."""

from benchmarks import Row
from benchmarks.smoothing import accuracy, features, speed


def run() -> list[Row]:
    """Errors by pulse and sampling, what the bands hold, and times up to a million samples."""
    return [*accuracy.run(), *features.run(), *speed.run()]
