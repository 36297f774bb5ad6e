# mypy: disable-error-code="no-untyped-call"
"""From a generated function to LLVM at once: numba would take far longer to read and type the same text.

A generated function assigns numbers, chooses by comparisons or by bits of its mode, and returns.
"""

import ast
import math
from collections.abc import Sequence
from typing import Any

from llvmlite import ir
from numba.core import cgutils

from crashkit.mechanics.laws.linking import FLOAT, INTEGER

INTRINSIC = ("sqrt", "exp", "log", "sin", "cos")
"""Functions that LLVM knows; the others are the C library's."""
OPERATORS = {
    ast.Add: ("fadd", "add"),
    ast.Sub: ("fsub", "sub"),
    ast.Mult: ("fmul", "mul"),
    ast.Div: ("fdiv", ""),
    ast.BitAnd: ("", "and_"),
    ast.BitOr: ("", "or_"),
}
"""Of floats and of whole numbers."""
COMPARISONS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}


def translate(module: ir.Module, kind: ir.FunctionType, definition: ast.FunctionDef) -> None:
    """Add a function to a module.

    Arguments:
        kind: types of its arguments and of what it returns; two values are an array.
        definition: its text, parsed.
    """
    target = ir.Function(module, kind, definition.name)
    target.attributes.add("nounwind")
    _Translation(target, [argument.arg for argument in definition.args.args]).body(definition.body)


class _Translation:
    """Puts statements into a function of LLVM: each variable has a place of its own, which LLVM makes a register."""

    def __init__(self, target: ir.Function, names: Sequence[str]) -> None:
        self.build = ir.IRBuilder(target.append_basic_block())
        self.places: dict[str, Any] = {}
        for name, argument in zip(names, target.args, strict=True):
            self.store(name, argument)

    # statements

    def body(self, statements: Sequence[ast.stmt]) -> None:
        self.block(statements)
        if not self.build.block.is_terminated:  # both sides of the last choice have returned
            self.build.unreachable()

    def block(self, statements: Sequence[ast.stmt]) -> None:
        for statement in statements:
            self.statement(statement)

    def statement(self, statement: ast.stmt) -> None:
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self.store(name, self.value(value))
            case ast.Assign(targets=[ast.Subscript() as entry], value=value):
                self.build.store(self.value(value), self.address(entry))
            case ast.AugAssign(target=ast.Name(id=name), op=op, value=value):
                self.store(name, self.value(ast.BinOp(ast.Name(name), op, value)))
            case ast.If(test=test, body=body, orelse=orelse):
                with self.build.if_else(self.test(test)) as (then, otherwise):
                    with then:
                        self.block(body)
                    with otherwise:
                        self.block(orelse)
            case ast.Return(value=ast.Tuple(elts=values)):
                self.build.ret(self.together([self.value(value) for value in values]))
            case ast.Return(value=ast.expr() as value):
                self.build.ret(self.value(value))
            case ast.Pass():
                pass
            case _:
                raise NotImplementedError(ast.unparse(statement))

    def store(self, name: str, value: Any) -> None:
        if name not in self.places:
            with self.build.goto_entry_block():
                self.places[name] = self.build.alloca(value.type)
        self.build.store(value, self.places[name])

    # expressions

    def value(self, node: ast.expr) -> Any:
        match node:
            case ast.Constant(value=number):
                return ir.Constant(FLOAT if isinstance(number, float) else INTEGER, number)
            case ast.Name(id=name):
                return self.build.load(self.places[name])
            case ast.Attribute(value=ast.Name(id="math"), attr=name):
                return ir.Constant(FLOAT, getattr(math, name))
            case ast.Subscript(slice=ast.Slice(lower=ast.expr() as first)):
                return self.build.gep(self.value(node.value), [self.value(first)])
            case ast.Subscript():
                return self.build.load(self.address(node))
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                value = self.value(operand)
                return self.build.fneg(value) if value.type == FLOAT else self.build.neg(value)
            case ast.BinOp(left=left, op=op, right=right):
                return self.operation(self.value(left), op, self.value(right))
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return self.build.select(self.test(test), self.value(body), self.value(orelse))
            case ast.Call(func=ast.Name(id="min"), args=[first, second]):
                one, other = self.value(first), self.value(second)
                return self.build.select(self.build.fcmp_ordered("<", other, one), other, one)
            case ast.Call(func=ast.Attribute(value=ast.Name(id="math"), attr=name), args=[argument]):
                return self.call(f"llvm.{name}.f64" if name in INTRINSIC else name, self.value(argument))
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self.call(name, *map(self.value, arguments))
            case _:
                raise NotImplementedError(ast.unparse(node))

    def operation(self, left: Any, op: ast.operator, right: Any) -> Any:
        if isinstance(op, ast.Pow):
            return self.call("llvm.pow.f64", left, right)
        of_floats, of_integers = OPERATORS[type(op)]
        if left.type == FLOAT:
            return getattr(self.build, of_floats)(left, right, flags=("contract",))
        return getattr(self.build, of_integers)(left, right)

    def test(self, node: ast.expr) -> Any:
        """One bit: a comparison, or whether any bit of a whole number is set."""
        if not isinstance(node, ast.Compare):
            return self.build.icmp_signed("!=", self.value(node), ir.Constant(INTEGER, 0))
        left, right, sign = self.value(node.left), self.value(node.comparators[0]), COMPARISONS[type(node.ops[0])]
        if left.type == INTEGER:
            return self.build.icmp_signed(sign, left, right)
        return (self.build.fcmp_unordered if sign == "!=" else self.build.fcmp_ordered)(sign, left, right)

    def call(self, name: str, *values: Any) -> Any:
        kind = ir.FunctionType(FLOAT, [value.type for value in values])
        return self.build.call(cgutils.get_or_insert_function(self.build.module, kind, name), values)

    def together(self, values: Sequence[Any]) -> Any:
        both = ir.Constant(ir.ArrayType(FLOAT, len(values)), ir.Undefined)
        for i, value in enumerate(values):
            both = self.build.insert_value(both, value, i)
        return both

    def address(self, entry: ast.Subscript) -> Any:
        return self.build.gep(self.value(entry.value), [self.value(entry.slice)])
