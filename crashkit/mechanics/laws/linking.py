# mypy: disable-error-code="no-untyped-call"
"""How the compiled kernel calls the functions of a law: by a table of their addresses, which is all that it knows of it.

So the kernel is compiled once for all laws, and a law once for all models.
"""

import inspect
from collections.abc import Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

FLOAT, INTEGER = ir.DoubleType(), ir.IntType(64)
STATE = ("d", "ddot", "d_max", "z")
ARGUMENTS = {
    "mode": (*STATE, "p", "o"),
    "frozen": ("mode", *STATE, "p", "o"),
    "distance": ("which", "mode", *STATE, "p", "o"),
    "partials": ("mode", *STATE, "p", "o", "out"),
    "guard": ("mode", *STATE, "p", "o", "out"),
}
"""Of the functions of a law, in the order of its table. Whole numbers are `which`, `mode` and `o`, arrays of floats `p` and
`out`, the others floats."""
PAIR = types.UniTuple(types.float64, 2)
RETURNS = {"mode": types.int64, "frozen": PAIR, "distance": types.float64, "partials": types.float64, "guard": types.float64}
ARRAYS = ("p", "out")
LLVM = dict.fromkeys(("which", "mode", "o"), INTEGER) | dict.fromkeys(ARRAYS, FLOAT.as_pointer())
"""Types of the arguments that are not floats."""


def _signature(kind: str) -> Any:
    arrays = dict.fromkeys(ARRAYS, types.CPointer(types.float64))
    returned = types.complex128 if RETURNS[kind] is PAIR else RETURNS[kind]
    return returned(*[arrays.get(name, _numba(name)) for name in ARGUMENTS[kind]])


def _numba(name: str) -> Any:
    return types.int64 if name == "code" or name in LLVM else types.float64


SIGNATURES = {kind: _signature(kind) for kind in ARGUMENTS}
"""Of what numba compiles of a law; a complex number is returned as two floats are."""


def type_of(kind: str) -> ir.FunctionType:
    """The type of such a function of a law."""
    returned = {types.int64: INTEGER, types.float64: FLOAT, PAIR: ir.ArrayType(FLOAT, 2)}[RETURNS[kind]]
    return ir.FunctionType(returned, [LLVM.get(name, FLOAT) for name in ARGUMENTS[kind]])


def caller(kind: str) -> Any:
    """For numba: a call of the function of this kind of the law whose table is at the address that comes first."""
    names = ("code", *ARGUMENTS[kind])

    def typed(_: Any, *given: Any) -> Any:
        wanted = [array if name in ARRAYS else _numba(name) for name, array in zip(names, given, strict=True)]
        return RETURNS[kind](*wanted), call

    def call(context: Any, builder: ir.IRBuilder, signature: Any, values: Sequence[Any]) -> Any:
        table, *given = (
            make_array(of)(context, builder, value).data if name in ARRAYS else value
            for name, of, value in zip(names, signature.args, values, strict=True)
        )
        place = builder.inttoptr(table, type_of(kind).as_pointer().as_pointer())
        function = builder.load(builder.gep(place, [ir.Constant(INTEGER, list(ARGUMENTS).index(kind))]))
        return builder.call(function, given, attrs=("nounwind",))

    return _intrinsic(names, typed)


def _intrinsic(names: Sequence[str], typed: Any) -> Any:
    parameters = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in ("context", *names)]
    typed.__signature__ = inspect.Signature(parameters)
    return intrinsic(typed)


law_mode, law_frozen, law_distance, law_partials, law_guard = map(caller, ARGUMENTS)
