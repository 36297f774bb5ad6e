"""Compiled engines: one generated module for a set of laws, kept on disk."""

import hashlib
import importlib.util
import inspect
import os
import sys
import tempfile
import threading
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType

import numba
import platformdirs
from attrs import field, frozen

from crashkit.mechanics import kernel
from crashkit.mechanics.emit import emit
from crashkit.mechanics.law_source import LawFunction

HEADER = '''"""Written by crashkit.mechanics.engine; safe to delete."""

import math

from crashkit.mechanics.arrays import D_MAX, END, FORCE, REST, START
from numba import njit

compiled = njit(nogil=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


@compiled
def power_slope(base, exponent):
    return base**exponent * math.log(base) if base > 0.0 else 0.0
'''
KERNEL_MARK = "# ---- compiled from here ----"
ENTRY = "integrate"
DATED = 1_000_000_000
"""Modification time of a generated module: the same whoever writes it, so that compiled code stays valid."""
LOCK = threading.Lock()


@frozen(eq=False)
class Engine:
    """Compiled integration of any model whose laws, with the lengths of their vectors, are among `numbers`.

    Arguments:
        numbers: each function's number in the compiled dispatch.
        module: the generated module.
    """

    numbers: Mapping[LawFunction, int]
    module: ModuleType = field(repr=False)


def compile_engine(functions: Iterable[LawFunction]) -> Engine:
    """An engine for these functions: from this process, from disk, or newly written and compiled at its first run.

    Generated modules and their machine code are kept in the folder that the environment variable CRASHKIT_CACHE names, else in
    the user's cache folder, else in a temporary one.

    Raises:
        CrashkitError: a law holds something that cannot be compiled; names law, line and remedy.
    """
    ordered = tuple(sorted(set(functions), key=lambda function: (function.law.name, function.sizes)))
    with LOCK:
        return _engine(ordered)


@cache
def _engine(functions: tuple[LawFunction, ...]) -> Engine:
    source = _source(functions)
    key = hashlib.sha256(f"{numba.__version__} {sys.version} {source}".encode()).hexdigest()[:20]
    return Engine({function: number for number, function in enumerate(functions)}, _load(f"crashkit_engine_{key}", source))


def _source(functions: tuple[LawFunction, ...]) -> str:
    laws = [f"# {function.law.name} {function.sizes}\n{emit(function, f'law_{n}')}" for n, function in enumerate(functions)]
    dispatch = [
        _dispatch("mode", "", "p, o", "0", len(functions)),
        _dispatch("frozen", "mode, ", "p, o", "0.0, math.inf", len(functions)),
        _dispatch("partials", "mode, ", "p, o, out", "0.0", len(functions)),
    ]
    body = inspect.getsource(kernel).split(KERNEL_MARK, 1)[1]
    body = body.replace(f"@compiled\ndef {ENTRY}(", f'@njit(nogil=True, error_model="numpy", cache=True)\ndef {ENTRY}(')
    return "\n\n\n".join([HEADER, *laws, *dispatch, body.strip()]) + "\n"


def _dispatch(kind: str, first: str, last: str, none: str, count: int) -> str:
    arguments = f"{first}d, ddot, d_max, {last}"
    lines = ["@compiled", f"def law_{kind}(number, {arguments}):"]
    lines += [f"    if number == {n}:\n        return law_{n}_{kind}({arguments})" for n in range(count)]
    return "\n".join([*lines, f"    return {none}"])


def _load(name: str, source: str) -> ModuleType:
    path = _folder() / f"{name}.py"
    if not path.exists():
        _write(path, source)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def _write(path: Path, source: str) -> None:
    """Write at once, so that a process running beside this one sees all of it or nothing."""
    handle, draft = tempfile.mkstemp(dir=path.parent, suffix=".draft")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(source)
    os.utime(draft, (DATED, DATED))
    os.replace(draft, path)


def _folder() -> Path:
    """The first folder that can be written to."""
    wanted = os.environ.get("CRASHKIT_CACHE") or platformdirs.user_cache_path("crashkit") / "engines"
    for folder in (Path(wanted), Path(tempfile.gettempdir()) / f"crashkit-engines-{os.getpid()}"):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    raise OSError(f"no folder for compiled engines can be written: {wanted}")
