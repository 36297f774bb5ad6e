"""Compiled engines: one generated module for a number of axes, and the machine code of laws, kept on disk."""

import sys
import threading
import warnings
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from types import ModuleType

import numba
from attrs import field, frozen

from crashkit.errors import CrashkitError
from crashkit.mechanics.cache import digest, module_of
from crashkit.mechanics.laws.native import native
from crashkit.mechanics.laws.opaque import Opaque, OpaqueLawWarning
from crashkit.mechanics.laws.source import LawFunction

HEADER = '''"""Written by crashkit.mechanics.engine; safe to delete."""

import math

import numpy as np
from crashkit.mechanics.kernel.arrays import *
from crashkit.mechanics.laws.linking import law_distance, law_frozen, law_guard, law_mode, law_partials
from crashkit.mechanics.unaliased import Unaliased
from numba import njit

# to count references to arrays (_nrt) took half of a run, and the kernel makes no arrays
how = {"nogil": True, "error_model": "numpy", "fastmath": {"contract"}, "_nrt": False}
within = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
compiled, inlined = njit(**how, **within), njit(**how, **within, forceinline=True)
unaliased = njit(**how, **within, forceinline=True, pipeline_class=Unaliased)
entry = njit(**how, cache=True)
'''
KERNEL_MARK = "# ---- compiled from here ----"
KERNEL = Path(__file__).parent / "kernel"
USED = ("kernel/arrays.py", "laws/linking.py", "unaliased.py")
"""What a generated module takes from crashkit as it is."""
GEOMETRY = {1: ("line",), 2: ("plane",), 3: ("vectors", "rotations", "space")}
"""The modules of the kernel that know the geometry, by number of axes."""
MODULES = ("forces", "steps", "landing", "tangents", "jumps", "history", "between", "run", "adjoint", "along")
ENTRIES = ("integrate", "integrate_many", "sweep", "follow")
LOCK = threading.Lock()


@frozen(eq=False)
class Engine:
    """Compiled integration of any model of so many axes whose laws, with the lengths of their vectors, are among `codes`.

    Arguments:
        axes: 1, 2 (plane motion) or 3 (space).
        codes: of each function, where its machine code is in memory (see `Native`).
        module: the generated module.
        opaque: the functions that run as plain Python.
    """

    axes: int
    codes: Mapping[LawFunction, int]
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
    """An engine for these functions: from this process, from disk, or newly compiled.

    The kernel is compiled once for each number of axes, at its first run, and each law once. Both are kept in the folder that
    the environment variable CRASHKIT_CACHE names, else in the user's cache folder, else in a temporary one.

    Arguments:
        functions: laws and factors with the lengths of their vectors; see `functions_of`.
        axes: of the models: 1, 2 (plane motion) or 3 (space).

    Raises:
        CrashkitError: what a law declares and what its functions take do not agree; names law, line and remedy.

    Warns:
        OpaqueLawWarning: a law holds something that cannot be compiled, and so runs as plain Python.
    """
    with LOCK:
        return _engine(frozenset(functions), axes)


@cache
def _engine(functions: frozenset[LawFunction], axes: int) -> Engine:
    found = {function: native(function) for function in functions}
    opaque = {function: one.opaque for function, one in found.items() if one.opaque}
    for one in opaque.values():
        warnings.warn(str(one), OpaqueLawWarning, stacklevel=3)
    return Engine(axes, {function: one.code for function, one in found.items()}, _module(axes), opaque)


@cache
def _module(axes: int) -> ModuleType:
    source = "\n\n\n".join([HEADER, *(_text(module) for module in (*GEOMETRY[axes], *MODULES))]) + "\n"
    used = "".join((Path(__file__).parent / name).read_text(encoding="utf-8") for name in USED)
    return module_of(f"crashkit_engine_{digest(numba.__version__, sys.version, used, source)}", source)


@cache
def _text(module: str) -> str:
    text = (KERNEL / f"{module}.py").read_text(encoding="utf-8").split(KERNEL_MARK, 1)[1].strip()
    for entry in ENTRIES:
        text = text.replace(f"@compiled\ndef {entry}(", f"@entry\ndef {entry}(")
    return text
