"""The motion that a model predicts."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import options


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("simulate", help=__doc__, description=__doc__)
    parser.add_argument("model", metavar="MODEL", type=Path, help="model file (TOML)")
    parser.add_argument("--duration", metavar="SECONDS", type=float, required=True, help="from the first contact")
    output = options.file_with(".nc")
    parser.add_argument("--output", metavar="FILE.nc", type=output, required=True, help="file for the motion (netCDF)")
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Simulate and write the motion."""
    from crashkit import api
    from crashkit.data.files import check_outputs

    check_outputs([arguments.model], [arguments.output])
    print(api.simulate_file(arguments.model, arguments.duration, arguments.output))
