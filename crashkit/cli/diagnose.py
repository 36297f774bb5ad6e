"""Where a model and its recordings differ, and what physics the model left out."""

from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import progress


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("diagnose", help=__doc__, description=__doc__)
    parser.add_argument("model", metavar="MODEL", type=Path, help="model file (TOML)")
    parser.add_argument("runs", metavar="RUN", type=Path, nargs="+", help="recordings to fit (netCDF)")
    parser.add_argument(
        "--holdout",
        metavar="RUN",
        type=Path,
        nargs="+",
        action="extend",
        default=[],
        help="recordings that are predicted, not fitted, unless only more physics explains them",
    )
    parser.add_argument("--output", metavar="DIR", type=Path, required=True, help="folder for the report, made if need be")
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Diagnose, write the report, print the answer."""
    from crashkit import api

    diagnosis = api.diagnose_files(
        arguments.model, arguments.runs, arguments.holdout, arguments.output, progress=progress.show
    )
    print(diagnosis.summary)
