"""Registers the identifiers."""

from typing import Any

from crashkit.protocols import Identifier
from crashkit.registry import hookimpl
from crashkit_identifiers.sensitivity import Sensitivity


@hookimpl
def crashkit_identifiers() -> list[type[Identifier[Any]]]:
    """The identifiers of this distribution."""
    return [Sensitivity]
