"""Whether film and accelerometers of one recording agree; needs no model."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import progress

WRITTEN = ("index.html", "cross_check.nc")
"""In the folder for the report."""


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("cross-check", help=__doc__, description=__doc__)
    parser.add_argument("recording", metavar="RUN", type=Path, help="recording (netCDF)")
    parser.add_argument("--film", metavar="GROUP", default="film", help="group that saw the displacements (default: film)")
    parser.add_argument(
        "--accelerometer",
        metavar="GROUP",
        default="accelerometer",
        help="group that felt the accelerations (default: accelerometer)",
    )
    parser.add_argument(
        "--known-velocity", action="store_true", help="hold to the velocity of the group initial; else it is free"
    )
    parser.add_argument("--output", metavar="DIR", type=Path, required=True, help="folder for the report, made if need be")
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Compare, write the report, print the verdicts."""
    from crashkit import api
    from crashkit.data.files import check_outputs

    outputs = [arguments.output / name for name in WRITTEN]
    check_outputs([arguments.recording], outputs)
    groups = arguments.film, arguments.accelerometer
    print(api.cross_check_file(arguments.recording, *groups, arguments.known_velocity, arguments.output))
    progress.tell_written(outputs)
