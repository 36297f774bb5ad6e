"""Registers the formats."""

from crashkit.protocols import Importer
from crashkit.registry import hookimpl
from crashkit_formats.nhtsa import NhtsaImporter


@hookimpl
def crashkit_importers() -> list[type[Importer]]:
    """The formats of this distribution."""
    return [NhtsaImporter]
