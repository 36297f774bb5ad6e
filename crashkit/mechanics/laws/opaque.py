"""A law that can be neither derived nor pasted: compiled code calls it as plain Python, and says so."""

import ctypes
import hashlib
from collections.abc import Iterator, Sequence

import llvmlite.binding as llvm

from crashkit.mechanics.laws.source import LawFunction

CALLBACK = ctypes.CFUNCTYPE(ctypes.c_double, *[ctypes.c_double] * 4, ctypes.c_void_p)
"""(d, ddot, d_max, memory, address of the parameters) -> value."""


class OpaqueLawWarning(UserWarning):
    """A law runs as plain Python: slowly, its corners not met exactly, without sensitivities."""


class Opaque:
    """A law as plain Python that compiled code can call by a name.

    Arguments:
        function: of the law.
        reason: why it cannot be compiled.

    Attributes:
        problem: what went wrong when it was last called; the value was then NaN.
    """

    def __init__(self, function: LawFunction, reason: str) -> None:
        self.function = function
        self.reason = reason
        self.problem = ""
        self._callback = CALLBACK(self._value)  # lives as long as what calls it
        address = ctypes.cast(self._callback, ctypes.c_void_p).value
        llvm.add_symbol(_symbol(function), address)

    def __str__(self) -> str:
        return (
            f"{self.reason}: it runs as plain Python, slowly, its corners are not met exactly, and it gives no sensitivities"
        )

    def _value(self, d: float, ddot: float, d_max: float, memory: float, address: int) -> float:
        law, part = self.function.law, self.function.part
        numbers = (ctypes.c_double * self.function.count()).from_address(address)[:]
        state = (d, ddot, d_max, memory) if law.memory else (d, ddot, d_max)
        try:
            return float(getattr(law, part)(*state, *_arguments(self.function, numbers)))
        except Exception as error:  # nothing may be raised through compiled code
            self.problem = f"{law.name} at d = {d:g} m, ddot = {ddot:g} m/s: {type(error).__name__}: {error}"
            return float("nan")


def emit_opaque(function: LawFunction) -> str:
    """Source of the functions that the engine calls, around the law as plain Python."""
    state = "d, ddot, d_max, z"
    lines = {
        f"law_mode({state}, p, o)": "0",
        f"law_frozen(mode, {state}, p, o)": f"{_symbol(function)}({state}, p[o:]), math.inf",
        f"law_distance(which, mode, {state}, p, o)": "math.inf",
        f"law_partials(mode, {state}, p, o, out)": "math.nan",
    }
    return "\n".join(f"def {head}: return {value}" for head, value in lines.items())


def _symbol(function: LawFunction) -> str:
    """The name by which compiled code calls the law: the same in every process, so that the code can be kept."""
    law, code = function.law, getattr(getattr(function.law, function.part), "__code__", None)
    told = f"{law.__module__} {law.__qualname__} {law.name} {function.part} {function.sizes} {getattr(code, 'co_code', b'')!r}"
    return f"crashkit_{hashlib.sha256(told.encode()).hexdigest()[:20]}"


def _arguments(function: LawFunction, numbers: Sequence[float]) -> Iterator[float | Sequence[float]]:
    lengths, place = function.lengths(), 0
    for spec in function.law.parameters:
        length = lengths.get(spec.name, 1)
        yield numbers[place : place + length] if spec.vector else numbers[place]
        place += length
