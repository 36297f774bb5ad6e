"""The hooks: one for each kind of plugin.

A plugin's module of hooks defines any of these functions, marked with `hookimpl`. Each is called once in a process, the first
time that the registry is loaded, without arguments; it returns classes, and the name that users write is on the class.
"""

from typing import Any

from pluggy import HookimplMarker, HookspecMarker

from crashkit.protocols import Hypothesis, Identifier, Importer, Observer, Smoother, SpringLaw

hookspec = HookspecMarker("crashkit")
hookimpl = HookimplMarker("crashkit")


@hookspec
def crashkit_spring_laws() -> list[type[SpringLaw]]:
    """Fires when the registry is loaded; returns laws and factors, which a model's joints name as `law` and `factors`."""


@hookspec
def crashkit_observers() -> list[type[Observer]]:
    """Fires when the registry is loaded; returns instruments, which a recording's groups name as `observer`."""


@hookspec
def crashkit_smoothers() -> list[type[Smoother]]:
    """Fires when the registry is loaded; returns methods that smooth and differentiate samples."""


@hookspec
def crashkit_identifiers() -> list[type[Identifier[Any]]]:
    """Fires when the registry is loaded; returns methods that `crashkit identify --method` offers."""


@hookspec
def crashkit_hypotheses() -> list[type[Hypothesis]]:
    """Fires when the registry is loaded; returns the physics that a diagnosis considers, each under its `physics`."""


@hookspec
def crashkit_importers() -> list[type[Importer]]:
    """Fires when the registry is loaded; returns the file formats that `crashkit import` offers."""
