"""What is installed, from which distribution, and what failed to load and why."""

from argparse import ArgumentParser, Namespace
from typing import Any


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("plugins", help=__doc__, description=__doc__)
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Print the table, then the failures; the status is 0, as the listing itself succeeded."""
    from crashkit.registry import load

    registry = load()
    installed = sorted((plugin.kind, plugin.name, plugin.distribution, plugin.version) for plugin in registry.plugins)
    rows = [("kind", "name", "distribution", "version"), *installed]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    if registry.failures:
        print("\nfailed to load:")
    for failure in registry.failures:
        print(f"  {failure}")
