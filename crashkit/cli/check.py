"""Whether recordings and models keep the data contract, and models and recordings belong together."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("check", help=__doc__, description=__doc__)
    parser.add_argument("files", metavar="FILE", type=Path, nargs="+", help="recordings (netCDF) or models (TOML)")
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Check every file, and each model with all recordings; faults are raised together."""
    from crashkit import api

    print(api.check_files(arguments.files))
