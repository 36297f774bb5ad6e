# mypy: disable-error-code="no-untyped-call, misc"
"""The machine code of a law: compiled once on a computer, kept on disk, and called by its addresses."""

import ast
import sys
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
import numpy as np
from attrs import frozen
from llvmlite import ir

from crashkit.mechanics.cache import digest, keep, kept, module_of
from crashkit.mechanics.laws.emit import emit
from crashkit.mechanics.laws.linking import ARGUMENTS, type_of
from crashkit.mechanics.laws.opaque import Opaque, emit_opaque
from crashkit.mechanics.laws.own_branches import has_own_branches
from crashkit.mechanics.laws.source import LawFunction, OutsideSubset
from crashkit.mechanics.laws.translate import translate

FULLY = 3
"""How hard LLVM optimises."""
COMPILER = "".join(Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8") for name in ("native", "translate"))
"""What machine code depends on besides the law's text."""
HEADER = '''"""Written by crashkit.mechanics; safe to delete."""

import math
from functools import partial

import numpy as np
from crashkit.mechanics.laws.linking import SIGNATURES
from numba import carray, cfunc, njit

jitted = njit(nogil=True, error_model="numpy", fastmath={"contract"})
called = partial(cfunc, cache=True)'''
NO_GUARD = f"def law_guard({', '.join(ARGUMENTS['guard'])}): return math.inf"
"""Of a law whose value never jumps."""
NO_JUMP = f"@called(SIGNATURES['guard'])\ndef guard({', '.join(ARGUMENTS['guard'])}):\n    return math.inf"


@frozen(eq=False)
class Native:
    """A law in memory.

    Arguments:
        addresses: of its functions, in the order of `ARGUMENTS`: the table by which the kernel calls them.
        holder: what keeps them in memory.
        opaque: the law, where it runs as plain Python.
    """

    addresses: np.ndarray
    holder: Any
    opaque: Opaque | None = None

    @property
    def code(self) -> int:
        """Address of the table."""
        return int(self.addresses.ctypes.data)


@cache
def native(function: LawFunction) -> Native:
    """A law, from disk or newly compiled.

    Raises:
        CrashkitError: what a law declares and what its functions take do not agree; names law, line and remedy.
    """
    try:
        if not function.law.opaque and has_own_branches(function):
            return _by_numba(emit(function), function.count())
        return _by_llvm(emit(function))
    except OutsideSubset as error:
        opaque = Opaque(function, str(error))
    return _by_llvm(emit_opaque(function), opaque)


def _by_llvm(text: str, opaque: Opaque | None = None) -> Native:
    machine = _machine()
    name = f"crashkit_law_{digest(text, COMPILER, str(llvm.llvm_version_info), machine.triple, *_host())}.o"
    code = kept(name)
    if code is None:
        code = _compiled(text, machine)
        keep(name, code)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return Native(np.array([engine.get_function_address(f"law_{kind}") for kind in ARGUMENTS], np.int64), engine, opaque)


def _compiled(text: str, machine: llvm.TargetMachine) -> bytes:
    """The object file of a law."""
    module = ir.Module("law")
    module.triple = llvm.get_process_triple()
    for definition in ast.parse(text if "def law_guard" in text else f"{text}\n{NO_GUARD}").body:
        assert isinstance(definition, ast.FunctionDef)
        translate(module, type_of(definition.name.removeprefix("law_")), definition)
    parsed = llvm.parse_assembly(str(module))
    parsed.verify()
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=FULLY))
    builder.getModulePassManager().run(parsed, builder)
    return bytes(machine.emit_object(parsed))


def _by_numba(text: str, count: int) -> Native:
    """A law of so many parameters whose author wrote it for numba."""
    text = "\n\n\n".join([HEADER, text, *(_entry(kind, count) for kind in ARGUMENTS if kind != "guard"), NO_JUMP])
    module = module_of(f"crashkit_law_{digest(text, numba.__version__, sys.version)}", text)
    return Native(np.array([getattr(module, kind).address for kind in ARGUMENTS], np.int64), module)


def _entry(kind: str, count: int) -> str:
    """What makes a function that numba compiles one that can be called by its address."""
    rooms = {"p": f"carray(p, (o + {count},))", "out": f"carray(out, ({4 + count},))"}
    call = f"law_{kind}({', '.join(rooms.get(name, name) for name in ARGUMENTS[kind])})"
    returned = f"complex(*{call})" if kind == "frozen" else call
    return f"@called(SIGNATURES[{kind!r}])\ndef {kind}({', '.join(ARGUMENTS[kind])}):\n    return {returned}"


def _host() -> tuple[str, str]:
    """This computer's processor and what it can do."""
    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _machine() -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    cpu, features = _host()
    where = "static" if target.name.startswith("x86") else "default"  # as numba places its code
    return target.create_target_machine(cpu, features, FULLY, reloc=where, codemodel="jitdefault", jit=True)
