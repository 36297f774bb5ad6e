"""How soon a first answer comes, of whole processes: help, plugins, and the first result of a model.

Cold: nothing is compiled yet. Warm: another process has compiled the same laws before. With imports done: from a model that is
read to its motion. Beside it what Python itself and xarray take, the first result by scipy, and the C compiler with the
reference.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping

from benchmarks import Row, pair, seconds
from benchmarks._mechanics.models import cases
from benchmarks._mechanics.reference import Reference, compiler

MODELS = ("two degrees", "figure 3, oblique")
FIRST = """
from time import perf_counter
from benchmarks._mechanics.models import LAWS, cases
from crashkit.mechanics import simulate
case = next(case for case in cases() if case.name == {name!r})
start = perf_counter()
simulate(case.model, case.times, LAWS, step=case.step)
print(perf_counter() - start)
"""
SCIPY = """
from benchmarks._mechanics.models import cases
from benchmarks._mechanics.peers import peers
case = next(case for case in cases() if case.name == {name!r})
peers(case)["scipy DOP853"]()
"""


def run() -> list[Row]:
    """Wall times."""
    return [*_processes(), *(row for name in MODELS for row in _first(name))]


def _processes() -> list[Row]:
    pairs = [
        ("help", ["-m", "crashkit", "--help"], "python", ["-c", "pass"]),
        ("load every plugin", ["-c", "import crashkit.registry as r; r.load()"], "import xarray", ["-c", "import xarray"]),
    ]
    rows = []
    for case, ours, peer, theirs in pairs:
        mine, other = pair(_process(ours), _process(theirs))
        rows.append(Row(case, "time", "s", mine, peer, other))
    return rows


def _first(name: str) -> list[Row]:
    """The first result of a model; a cold start takes so long that it is measured once."""
    with tempfile.TemporaryDirectory() as cache:
        code = FIRST.format(name=name)
        process = _process(["-c", code], cache)
        cold = seconds(process)
        inside: list[str] = []
        whole = min(seconds(lambda: inside.append(process())) for _ in range(3))
    scipy = seconds(_process(["-c", SCIPY.format(name=name)])) if name == MODELS[0] else None
    return [
        Row(f"{name}: first result, cold", "time", "s", cold, "C compiler, reference", _compiled(name)),
        Row(f"{name}: first result, warm", "time", "s", whole, "scipy DOP853", scipy),
        Row(f"{name}: first result, warm, imports done", "time", "s", min(map(float, inside)), "", None),
    ]


def _compiled(name: str) -> float | None:
    case = next(case for case in cases() if case.name == name)
    return seconds(lambda: Reference(case.model)) if compiler() else None


def _process(arguments: list[str], cache: str = "") -> Callable[[], str]:
    """A fresh Python; what it prints."""
    own: Mapping[str, str] = {**os.environ, "CRASHKIT_CACHE": cache} if cache else os.environ
    return lambda: subprocess.run([sys.executable, *arguments], check=True, capture_output=True, text=True, env=own).stdout
