"""Registers the smoothers of this distribution."""

from crashkit.protocols import Smoother
from crashkit.registry import hookimpl
from crashkit_smoothers.adaptive_quintic import AdaptiveQuintic
from crashkit_smoothers.gcv_splines import GcvCubic, GcvHeptic, GcvQuintic
from crashkit_smoothers.spectral import Spectral


@hookimpl
def crashkit_smoothers() -> list[type[Smoother]]:
    return [AdaptiveQuintic, GcvCubic, GcvHeptic, GcvQuintic, Spectral]
