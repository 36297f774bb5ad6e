"""Registers the smoothers of this distribution."""

from crashkit.protocols import Smoother
from crashkit.registry import hookimpl
from crashkit_smoothers.gcv_quintic import GcvQuintic


@hookimpl
def crashkit_smoothers() -> list[type[Smoother]]:
    return [GcvQuintic]
