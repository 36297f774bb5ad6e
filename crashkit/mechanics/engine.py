"""Compiled engines: one generated module for a set of laws, kept on disk."""

import hashlib
import importlib.util
import os
import sys
import tempfile
import threading
import warnings
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType

import numba
import platformdirs
from attrs import field, frozen

from crashkit.errors import CrashkitError
from crashkit.mechanics.laws.emit import emit
from crashkit.mechanics.laws.linking import ARGUMENTS
from crashkit.mechanics.laws.opaque import Opaque, OpaqueLawWarning, emit_opaque
from crashkit.mechanics.laws.source import LawFunction, OutsideSubset

HEADER = '''"""Written by crashkit.mechanics.engine; safe to delete."""

import math

import numpy as np
from crashkit.mechanics.kernel.arrays import *
from crashkit.mechanics.laws.linking import Laws
from crashkit.mechanics.unaliased import Unaliased
from numba import njit, types

how = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}}
within = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
uncounted = {**how, "_nrt": False}  # to count references to arrays took half of a run, and the kernel makes no arrays
jitted = njit(**how, **within, _nrt=True)
compiled, inlined = njit(**uncounted, **within), njit(**uncounted, **within, forceinline=True)
unaliased = njit(**uncounted, **within, forceinline=True, pipeline_class=Unaliased)
entry = njit(**uncounted, cache=True)
laws = Laws(__name__)
scalar, definition = laws.add, laws.define()


@compiled
def define_laws():
    definition()
'''
KERNEL_MARK = "# ---- compiled from here ----"
KERNEL = Path(__file__).parent / "kernel"
USED = ("kernel/arrays.py", "laws/linking.py", "laws/translate.py", "unaliased.py")
"""What a generated module takes from crashkit as it is."""
GEOMETRY = {1: ("line",), 2: ("plane",), 3: ("vectors", "rotations", "space")}
"""The modules of the kernel that know the geometry, by number of axes."""
MODULES = ("forces", "steps", "landing", "tangents", "jumps", "history", "run", "adjoint", "along")
ENTRIES = ("integrate", "integrate_many", "sweep", "follow")
DATED = 1_000_000_000
"""Modification time of a generated module: the same whoever writes it, so that compiled code stays valid."""
LOCK = threading.Lock()


@frozen(eq=False)
class Engine:
    """Compiled integration of any model of so many axes whose laws, with the lengths of their vectors, are among `numbers`.

    Arguments:
        axes: 1, 2 (plane motion) or 3 (space).
        numbers: each function's number in the compiled dispatch.
        module: the generated module.
        opaque: the functions that run as plain Python.
    """

    axes: int
    numbers: Mapping[LawFunction, int]
    module: ModuleType = field(repr=False)
    opaque: Mapping[LawFunction, Opaque] = field(factory=dict)

    def check_derivatives(self, functions: Iterable[LawFunction]) -> None:
        """Raise CrashkitError where one of these functions runs as plain Python, and so has none."""
        for function in functions:
            if function in self.opaque:
                raise CrashkitError(
                    f"expected laws that give sensitivities, found {function.law.name}, which runs as plain Python "
                    f"({self.opaque[function].reason})"
                )

    def problem(self) -> str:
        """What last went wrong in a function that runs as plain Python; empty where nothing did."""
        return next((function.problem for function in self.opaque.values() if function.problem), "")


def compile_engine(functions: Iterable[LawFunction], axes: int = 1) -> Engine:
    """An engine for these functions: from this process, from disk, or newly written and compiled at its first run.

    Generated modules and their machine code are kept in the folder that the environment variable CRASHKIT_CACHE names, else in
    the user's cache folder, else in a temporary one.

    Arguments:
        functions: laws and factors with the lengths of their vectors; see `functions_of`.
        axes: of the models: 1, 2 (plane motion) or 3 (space).

    Raises:
        CrashkitError: what a law declares and what its functions take do not agree; names law, line and remedy.

    Warns:
        OpaqueLawWarning: a law holds something that cannot be compiled, and so runs as plain Python.
    """
    ordered = tuple(sorted(set(functions), key=lambda function: (function.law.name, function.sizes, function.part)))
    with LOCK:
        return _engine(ordered, axes)


@cache
def _engine(functions: tuple[LawFunction, ...], axes: int) -> Engine:
    laws, opaque = _laws(functions)
    for function in opaque.values():
        warnings.warn(str(function), OpaqueLawWarning, stacklevel=3)
    source = _source(laws, axes)
    used = "".join((Path(__file__).parent / name).read_text(encoding="utf-8") for name in USED)
    key = hashlib.sha256(f"{numba.__version__} {sys.version} {used} {source}".encode()).hexdigest()[:20]
    numbers = {function: number for number, function in enumerate(functions)}
    return Engine(axes, numbers, _load(f"crashkit_engine_{key}", source), opaque)


def _laws(functions: tuple[LawFunction, ...]) -> tuple[list[str], dict[LawFunction, Opaque]]:
    """The source of each function, and those that run as plain Python."""
    texts: list[str] = []
    opaque: dict[LawFunction, Opaque] = {}
    for number, function in enumerate(functions):
        try:
            text = emit(function, f"law_{number}")
        except OutsideSubset as error:
            opaque[function] = Opaque(function, str(error))
            text = emit_opaque(function, f"law_{number}")
        texts.append(f"# {function.law.name} {function.sizes}\n{text}")
    return texts, opaque


def _source(laws: list[str], axes: int) -> str:
    dispatch = [_dispatch(kind, arguments, laws) for kind, arguments in ARGUMENTS.items()]
    body = [_text(module) for module in (*GEOMETRY[axes], *MODULES)]
    return "\n\n\n".join([HEADER, *laws, *dispatch, *body]) + "\n"


@cache
def _text(module: str) -> str:
    text = (KERNEL / f"{module}.py").read_text(encoding="utf-8").split(KERNEL_MARK, 1)[1].strip()
    for entry in ENTRIES:
        text = text.replace(f"@compiled\ndef {entry}(", f"@entry\ndef {entry}(")
    return text


def _dispatch(kind: str, arguments: Iterable[str], laws: list[str]) -> str:
    """What calls a function of any law; those that numba compiles are called by their names."""
    given = ", ".join(arguments)
    compiled = [n for n, text in enumerate(laws) if f"@jitted\ndef law_{n}_{kind}(" in text]
    lines = ["@compiled", f"def law_{kind}(number, {given}):"]
    lines += [f"    if number == {n}:\n        return law_{n}_{kind}({given})" for n in compiled]
    return "\n".join([f'other_{kind} = laws.call("{kind}")', "", "", *lines, f"    return other_{kind}(number, {given})"])


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
