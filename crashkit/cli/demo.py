"""Conceals a piece of physics in made-up recordings, finds it, and opens the seal."""

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from pathlib import Path
from typing import Any

from crashkit.cli import progress


def register(commands: Any) -> None:
    """Add the command."""
    parser: ArgumentParser = commands.add_parser("demo", help=__doc__, description=__doc__)
    parser.add_argument("--seed", metavar="N", type=_seed, help="which secret; omitted: a new one each time")
    parser.add_argument("--output", metavar="DIR", type=Path, default=Path("demo"), help="folder for everything (%(default)s)")
    parser.add_argument("--no-open", dest="open_page", action="store_false", help="do not open the page in a browser")
    parser.set_defaults(run=run)


def run(arguments: Namespace) -> None:
    """Conceal, diagnose, show, reveal."""
    from crashkit import api

    print(api.run_demo(arguments.seed, arguments.output, arguments.open_page, progress=progress.show))


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise ArgumentTypeError(f"expected a whole number from 0 on, found {text!r}")
    return int(text)
