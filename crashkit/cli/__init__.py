"""The command line: thin, one module for each command; the work is in `crashkit.api`.

Only a command that runs imports what it needs, so that help appears at once.
"""

import os
import sys
import warnings
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from importlib.metadata import version
from typing import NoReturn

from crashkit.cli import check, cross_check, demo, diagnose, identify, import_, plugins, simulate
from crashkit.errors import CrashkitError

USER_ERROR = 2
INTERRUPTED = 130
CLOSED_PIPE = 141
"""As of a program that the signal of a closed pipe ends."""

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""What the libraries behind numpy read once, when they are loaded."""

COMMANDS = (diagnose, simulate, identify, cross_check, import_, check, demo, plugins)


class Parser(ArgumentParser):
    """A parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong, and where help is, and exit."""
        _complain(f"{message} (see `{self.prog} --help`)")
        raise SystemExit(USER_ERROR)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Arguments:
        argv: without the program's name; None: those of the process.

    Returns:
        the exit status: 0; 2 for an error that the user can mend, told on stderr; 130 where the user interrupted; 141, without
        a word, where nobody reads on, as of `crashkit ... | head`.
    """
    try:
        try:
            return _ended(argv)
        finally:
            sys.stdout.flush()  # what waits there would meet the closed pipe when the process ends
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return CLOSED_PIPE


def _ended(argv: Sequence[str] | None) -> int:
    """The exit status of a command, its errors told."""
    arguments = parser().parse_args(argv)
    use_one_thread()
    try:
        _warn_of_failed_plugins(arguments)
        _run(arguments)
    except CrashkitError as error:
        _complain(str(error))
        return USER_ERROR
    except BrokenPipeError:
        raise
    except OSError as error:
        _complain(f"{error.filename}: {error.strerror}" if error.filename else str(error))
        return USER_ERROR
    except KeyboardInterrupt:
        _complain("interrupted")
        return INTERRUPTED
    return 0


def parser() -> Parser:
    """The parser of every command."""
    root = Parser("crashkit", description="Finds the physics that a crash model left out.")
    root.add_argument("--version", action="version", version=f"crashkit {version('crashkit')}")
    commands = root.add_subparsers(title="commands", metavar="COMMAND", dest="command", required=True)
    for command in COMMANDS:
        command.register(commands)
    return root


def use_one_thread() -> None:
    """Before numpy is loaded: the work is many small matrices, on which threads only wait for each other."""
    for variable in THREADS:
        os.environ.setdefault(variable, "1")


def _run(arguments: Namespace) -> None:
    """What a command, or a plugin in it, warns of goes to stderr like every other line."""
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: _complain(f"warning: {message}")
        arguments.run(arguments)


def _warn_of_failed_plugins(arguments: Namespace) -> None:
    """A plugin that failed may be the one that the work needed: say so, except where the command lists failures itself."""
    from crashkit.registry import load

    if arguments.run is not plugins.run and load().warning:
        _complain(load().warning)


def _complain(message: str) -> None:
    for line in message.splitlines():
        print(f"crashkit: {line}", file=sys.stderr)
