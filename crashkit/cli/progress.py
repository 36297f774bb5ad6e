"""Progress of long work, on stderr so that the answer on stdout stays clean; and what was written, which ends the answer."""

import sys
from collections.abc import Iterable
from pathlib import Path


def show(message: str) -> None:
    """Show one step of the work."""
    print(message, file=sys.stderr, flush=True)


def tell_written(files: Iterable[Path | None]) -> None:
    """Say which files hold the answer; None: one that was not wanted."""
    for file in filter(None, files):
        print(f"wrote {file}")
