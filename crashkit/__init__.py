"""crashkit: models, observes and identifies crash structures, and finds the physics that a model left out.

Begin with `crashkit.api`: what the command line does, as functions on files. Below it is a room for each part of the work,
loaded where it is first used:

    model       bodies, joints and their parameters
    mechanics   simulation of a model, with sensitivities
    data        recordings and motions, reading and writing
    misfit      a model against recordings
    diagnose    where they differ, and why
    report      figures and pages of results
    campaign    many simulations or fits
    registry    what is installed: spring laws, instruments, methods, hypotheses, formats
    protocols   what a plugin implements
    testing     contracts for plugins, and toys with known answers
    errors      what is raised for input that a user can mend
"""

from importlib import import_module
from types import ModuleType

__all__ = [
    "api",
    "campaign",
    "data",
    "diagnose",
    "errors",
    "mechanics",
    "misfit",
    "model",
    "protocols",
    "registry",
    "report",
    "testing",
]


def __dir__() -> list[str]:
    """What people see where they ask for completion."""
    return __all__


def __getattr__(name: str) -> ModuleType:
    """A room, loaded where it is first used: so that the package itself loads at once."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return import_module(f"{__name__}.{name}")
