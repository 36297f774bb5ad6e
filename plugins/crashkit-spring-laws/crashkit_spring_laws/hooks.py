"""Registers the spring laws of this distribution."""

from crashkit.protocols import SpringLaw
from crashkit.registry import hookimpl
from crashkit_spring_laws import SPRING_LAWS


@hookimpl
def crashkit_spring_laws() -> list[type[SpringLaw]]:
    """Every law and factor of this distribution."""
    return list(SPRING_LAWS)
