"""Progress of long work, on stderr so that the answer on stdout stays clean."""

import sys


def show(message: str) -> None:
    """Show one step of the work."""
    print(message, file=sys.stderr, flush=True)
