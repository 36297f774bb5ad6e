"""How soon the command line answers: help, and the plugins loaded, beside what Python itself and xarray take."""

import subprocess
import sys
from collections.abc import Callable

from benchmarks import Row, pair


def run() -> list[Row]:
    """Wall times of whole processes."""
    cases = [
        ("help", ["-m", "crashkit", "--help"], "python", ["-c", "pass"]),
        ("load every plugin", ["-c", "import crashkit.registry as r; r.load()"], "import xarray", ["-c", "import xarray"]),
    ]
    rows = []
    for case, ours, peer, theirs in cases:
        mine, other = pair(_process(ours), _process(theirs))
        rows.append(Row(case, "time", "s", mine, peer, other))
    return rows


def _process(arguments: list[str]) -> Callable[[], object]:
    return lambda: subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
