"""Where a model and its recordings differ, and what physics the model left out."""

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import progress

TIME_LIMIT = 180.0
"""s for questions."""
WRITTEN = ("index.html", "diagnosis.json", "curves.nc", "augmented_model.toml")
"""In the folder for the report."""


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
    parser.add_argument(
        "--time-limit",
        metavar="S",
        type=_seconds,
        default=TIME_LIMIT,
        help="s after which no further cause is asked for, and what was found is told (%(default)s); inf: ask everything",
    )
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Diagnose, write the report, print the answer."""
    from crashkit import api
    from crashkit.data.files import check_outputs

    outputs = [arguments.output / name for name in WRITTEN]
    check_outputs([arguments.model, *arguments.runs, *arguments.holdout], outputs)
    diagnosis = api.diagnose_files(
        arguments.model,
        arguments.runs,
        arguments.holdout,
        arguments.output,
        progress=progress.show,
        seconds=arguments.time_limit,
    )
    print(diagnosis.summary)
    progress.tell_written(outputs)


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = 0.0
    if not seconds > 0.0:
        raise ArgumentTypeError(f"expected seconds above 0, found {text!r}")
    return seconds
