"""A model's free parameters from recordings."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import progress


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("identify", help=__doc__, description=__doc__)
    parser.add_argument("model", metavar="MODEL", type=Path, help="model file (TOML)")
    parser.add_argument("runs", metavar="RUN", type=Path, nargs="+", help="recordings to fit (netCDF)")
    parser.add_argument("--method", metavar="NAME", default="multi_start", help="an installed identifier (%(default)s)")
    parser.add_argument("--output", metavar="MODEL.toml", type=Path, required=True, help="file for the identified model")
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Identify, write the model, print what was found."""
    from crashkit import api

    print(api.identify_files(arguments.model, arguments.runs, arguments.method, arguments.output, progress=progress.show))
