"""Registers the law."""

from crashkit.protocols import SpringLaw
from crashkit.registry import hookimpl
from crashkit_example_law.hardening import Hardening


@hookimpl
def crashkit_spring_laws() -> list[type[SpringLaw]]:
    """The laws of this distribution."""
    return [Hardening]
