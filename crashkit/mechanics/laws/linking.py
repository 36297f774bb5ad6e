# mypy: disable-error-code="no-untyped-call"
"""How the compiled kernel reaches the functions of the laws.

numba optimises a function together with all that it calls. Laws deep in the kernel would go through that again at every
level, so those who call them know no more than a name; only `define_laws` and who calls that have the laws themselves. It must
be the first that is compiled.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

from crashkit.mechanics.laws.translate import FLOAT, INTEGER, translate

STATE = ("d", "ddot", "d_max", "z")
ARGUMENTS = {
    "mode": (*STATE, "p", "o"),
    "frozen": ("mode", *STATE, "p", "o"),
    "distance": ("which", "mode", *STATE, "p", "o"),
    "partials": ("mode", *STATE, "p", "o", "out"),
    "guard": ("mode", *STATE, "p", "o", "out"),
}
"""Of the functions of a law. Whole numbers are `which`, `mode` and `o`, arrays of floats `p` and `out`, the others floats."""
PAIR = types.UniTuple(types.float64, 2)
RETURNS = {"mode": types.int64, "frozen": PAIR, "distance": types.float64, "partials": types.float64, "guard": types.float64}
NOTHING: Mapping[str, Any] = {"mode": 0, "frozen": (0.0, math.inf), "distance": math.inf, "partials": 0.0, "guard": math.inf}
"""What stands for a law without such a function."""
ARRAYS = ("p", "out")
LLVM = dict.fromkeys(("number", "which", "mode", "o"), INTEGER) | dict.fromkeys(ARRAYS, FLOAT.as_pointer())
"""Types of the arguments that are not floats."""


class Laws:
    """The functions of the laws of one engine.

    Arguments:
        engine: its name, which no other engine has.
    """

    def __init__(self, engine: str) -> None:
        self.engine = engine
        self.written: dict[str, dict[int, Callable[..., Any]]] = {kind: {} for kind in ARGUMENTS}

    def add(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Take in a generated function, whose name says the law's number and the kind."""
        _, number, kind = function.__name__.split("_")
        self.written[kind][int(number)] = function
        return function

    def call(self, kind: str) -> Any:
        """For numba: a call of the function of this kind of the law whose number comes first."""
        names = ("number", *ARGUMENTS[kind])

        def typed(_: Any, *given: Any) -> Any:
            wanted = [array if name in ARRAYS else _numba(name) for name, array in zip(names, given, strict=True)]
            return RETURNS[kind](*wanted), call

        def call(context: Any, builder: ir.IRBuilder, signature: Any, values: Sequence[Any]) -> Any:
            given = [
                make_array(of)(context, builder, value).data if name in ARRAYS else value
                for name, of, value in zip(names, signature.args, values, strict=True)
            ]
            return builder.call(self.finder(builder.module, kind), given)

        return _intrinsic(names, typed)

    def define(self) -> Any:
        """For numba: a call that defines all laws in the module of the function that calls it."""

        def define(context: Any, builder: ir.IRBuilder, *_: Any) -> Any:
            for kind in ARGUMENTS:
                self.define_finder(builder.module, kind)
            return context.get_dummy_value()

        return _intrinsic((), lambda _: (types.none(), define))

    def finder(self, module: ir.Module, kind: str) -> ir.Function:
        """The function that finds a law by its number."""
        returned = {types.int64: INTEGER, types.float64: FLOAT, PAIR: ir.ArrayType(FLOAT, 2)}[RETURNS[kind]]
        found = cgutils.get_or_insert_function(module, _type(returned, ("number", *ARGUMENTS[kind])), f"{self.engine}_{kind}")
        found.attributes.add("nounwind")
        return found

    def define_finder(self, module: ir.Module, kind: str) -> None:
        """Define it, with the laws that it finds."""
        target = self.finder(module, kind)
        target.linkage = "weak_odr"
        returned = target.function_type.return_type
        build = ir.IRBuilder(target.append_basic_block())
        nothing = target.append_basic_block()
        choice = build.switch(target.args[0], nothing)
        for number, function in self.written[kind].items():
            build.position_at_end(target.append_basic_block())
            choice.add_case(ir.Constant(INTEGER, number), build.block)
            law = translate(module, _type(returned, ARGUMENTS[kind]), function)
            build.ret(build.call(law, target.args[1:]))
        build.position_at_end(nothing)
        build.ret(ir.Constant(returned, NOTHING[kind]))


def _type(returned: ir.Type, names: Sequence[str]) -> ir.FunctionType:
    return ir.FunctionType(returned, [LLVM.get(name, FLOAT) for name in names])


def _numba(name: str) -> Any:
    return types.int64 if name in LLVM else types.float64


def _intrinsic(names: Sequence[str], typed: Callable[..., Any]) -> Any:
    parameters = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in ("context", *names)]
    typed.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return intrinsic(typed)
