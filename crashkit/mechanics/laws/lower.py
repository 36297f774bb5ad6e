"""From the syntax tree of a law to its program: loops unrolled, min, max and abs made branches, single assignments."""

import ast
import math
from collections.abc import Callable, Iterator, Sequence

from crashkit.mechanics.laws.functions import DERIVATIVES
from crashkit.mechanics.laws.source import LawFunction, LawSource, read_law, state_of
from crashkit.mechanics.laws.program import Assign, Block, Branch, Program, Return, Scope, names_in, returns

MAX_BITS = 62
GREATER = (ast.Gt, ast.GtE)
LESS = (ast.Lt, ast.LtE)
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)
SUBSET = "use assignments, if, min, max, abs, arithmetic, functions of math and loops over vector parameters"

Statements = list[Assign | Branch | Return]
Filler = Callable[[Statements], None]


def lower(function: LawFunction) -> Program:
    """The program of a law; raises CrashkitError, naming law, line and remedy, for what a law may not contain."""
    return _Lowering(read_law(function.law, function.part)).program(function)


class _Lowering:
    def __init__(self, source: LawSource) -> None:
        self.source = source
        self.scope: dict[str, ast.expr | list[ast.expr]] = {}
        self.dynamic: set[str] = set()
        self.variables = 0
        self.bits = 0

    def program(self, function: LawFunction) -> Program:
        names = state_of(function.law)
        state = tuple(self.fresh(name) for name in (*names, "memory")[:4])
        self.dynamic.update(state)
        self.scope.update(zip(names, map(_name, state), strict=False))
        lengths = function.lengths()
        parameters: list[str] = []
        for spec in function.law.parameters:
            variables = [self.fresh(spec.name) for _ in range(lengths.get(spec.name, 1))]
            entries = [_name(variable) for variable in variables]
            self.scope[spec.name] = list(entries) if spec.vector else entries[0]
            parameters += variables
        block = self.block(self.source.tree.body)
        if not returns(block):
            self.source.refuse(self.source.tree, "a path without return", "return the force on every path")
        if self.bits > MAX_BITS:
            self.source.refuse(self.source.tree, f"{self.bits} branches", f"at most {MAX_BITS} are possible: use fewer knots")
        return Program(state, tuple(parameters), block, self.bits)

    def fresh(self, name: str) -> str:
        self.variables += 1
        return f"{name}_{self.variables}"

    # statements

    def block(self, statements: Sequence[ast.stmt]) -> Block:
        out: Statements = []
        pending = list(statements)
        while pending and not returns(tuple(out)):
            statement = pending.pop(0)
            if isinstance(statement, ast.For):
                pending[:0] = self.unrolled(statement)
            elif isinstance(statement, ast.If) and _has_return(statement):
                rest, pending = pending, []
                self.fork(statement.test, self.filler([*statement.body, *rest]), self.filler([*statement.orelse, *rest]), out)
            else:
                self.statement(statement, out)
        return tuple(out)

    def filler(self, statements: Sequence[ast.stmt]) -> Filler:
        return lambda out: out.extend(self.block(statements))

    def statement(self, statement: ast.stmt, out: Statements) -> None:
        match statement:
            case ast.Return(value=ast.expr() as value):
                out.append(Return(self.expression(value, out)))
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self.bind(name, self.expression(value, out), out)
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)) if len(names) == len(values):
                self.bind_all(statement, names, [self.expression(value, out) for value in values], out)
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
                self.bind(name, self.expression(value, out), out)
            case ast.AugAssign(target=ast.Name(id=name) as target, op=op, value=value):
                total = ast.BinOp(ast.copy_location(ast.Name(name), target), op, value)
                self.bind(name, self.expression(ast.copy_location(total, statement), out), out)
            case ast.If(test=test, body=body, orelse=orelse):
                self.fork(test, self.filler(body), self.filler(orelse), out)
            case ast.Pass() | ast.Expr(value=ast.Constant()):
                pass
            case _:
                self.source.refuse(statement, f"`{ast.unparse(statement).splitlines()[0]}`", SUBSET)

    def bind(self, name: str, value: ast.expr, out: Statements) -> None:
        if not isinstance(value, ast.Name | ast.Constant):
            variable = self.fresh(name)
            if self.is_dynamic(value):
                self.dynamic.add(variable)
            out.append(Assign(variable, value))
            value = _name(variable)
        self.scope[name] = value

    def bind_all(self, statement: ast.stmt, names: list[ast.expr], values: list[ast.expr], out: Statements) -> None:
        for name, value in zip(names, values, strict=True):
            if not isinstance(name, ast.Name):
                self.source.refuse(statement, f"`{ast.unparse(statement)}`", SUBSET)
            self.bind(name.id, value, out)

    def unrolled(self, loop: ast.For) -> Iterator[ast.stmt]:
        match loop:
            case ast.For(target=ast.Name() as index, iter=ast.Call(func=ast.Name(id="range"), args=limits), orelse=[]):
                for i in range(*(self.integer(limit) for limit in limits)):
                    yield from [_assign(index, ast.Constant(i), loop), *loop.body]
            case ast.For(
                target=ast.Tuple(elts=[ast.Name() as index, ast.Name() as entry]),
                iter=ast.Call(func=ast.Name(id="enumerate"), args=[ast.Name() as vector]),
                orelse=[],
            ):
                for i in range(self.length(vector)):
                    value = ast.Subscript(vector, ast.Constant(i))
                    yield from [_assign(index, ast.Constant(i), loop), _assign(entry, value, loop), *loop.body]
            case _:
                self.source.refuse(
                    loop,
                    f"`for {ast.unparse(loop.target)} in {ast.unparse(loop.iter)}`",
                    "loop over range(...) or enumerate(vector)",
                )

    # branches

    def fork(self, test: ast.expr, body: Filler, orelse: Filler, out: Statements) -> None:
        """Append the branch of a test: `and`, `or`, `not` and chains become branches within branches."""
        match test:
            case ast.BoolOp(op=ast.And(), values=[first, *others]) if others:
                rest = others[0] if len(others) == 1 else ast.BoolOp(ast.And(), others)
                self.fork(first, lambda inner: self.fork(rest, body, orelse, inner), orelse, out)
            case ast.BoolOp(op=ast.Or(), values=[first, *others]) if others:
                rest = others[0] if len(others) == 1 else ast.BoolOp(ast.Or(), others)
                self.fork(first, body, lambda inner: self.fork(rest, body, orelse, inner), out)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                self.fork(operand, orelse, body, out)
            case ast.Compare(left=left, ops=[op, *ops], comparators=[right, *comparators]) if ops:
                first, rest = ast.Compare(left, [op], [right]), ast.Compare(right, ops, comparators)
                both = ast.BoolOp(ast.And(), [ast.copy_location(first, test), ast.copy_location(rest, test)])
                self.fork(both, body, orelse, out)
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                self.compare(test, self.expression(left, out), op, self.expression(right, out), body, orelse, out)
            case _:
                self.compare(test, self.expression(test, out), ast.NotEq(), ast.Constant(0.0), body, orelse, out)

    def compare(
        self, node: ast.AST, left: ast.expr, op: ast.cmpop, right: ast.expr, body: Filler, orelse: Filler, out: Statements
    ) -> None:
        test = ast.Compare(left, [op], [right])
        if isinstance(left, ast.Constant) and isinstance(right, ast.Constant):
            (body if _evaluate(test) else orelse)(out)
            return
        guard, bit = None, None
        if self.is_dynamic(left) or self.is_dynamic(right):
            guard, bit = self.guard(node, left, op, right), self.bits
            self.bits += 1
        before = dict(self.scope)
        taken = self.side(body, before)
        other = self.side(orelse, before)
        self.merge(before, taken, other, dynamic=bit is not None)
        out.append(Branch(test, guard, bit, tuple(taken[0]), tuple(other[0])))

    def guard(self, node: ast.AST, left: ast.expr, op: ast.cmpop, right: ast.expr) -> ast.expr:
        if isinstance(op, GREATER):
            return ast.BinOp(left, ast.Sub(), right)
        if isinstance(op, LESS):
            return ast.BinOp(right, ast.Sub(), left)
        self.source.refuse(node, "a state compared for equality", "compare with <, <=, > or >=")

    def side(self, fill: Filler, before: Scope) -> tuple[Statements, dict[str, ast.expr | list[ast.expr]]]:
        out: Statements = []
        self.scope = dict(before)
        fill(out)
        return out, self.scope

    def merge(
        self,
        before: Scope,
        taken: tuple[Statements, dict[str, ast.expr | list[ast.expr]]],
        other: tuple[Statements, dict[str, ast.expr | list[ast.expr]]],
        dynamic: bool,
    ) -> None:
        """Give each name that the two sides leave with different values one variable that both assign."""
        self.scope = dict(before)
        sides = [side for side in (taken, other) if not returns(tuple(side[0]))]
        if len(sides) == 1:
            self.scope = sides[0][1]
        if len(sides) < 2:
            return
        for name in (name for name in taken[1] if name in other[1]):
            first, second = taken[1][name], other[1][name]
            if isinstance(first, list) or isinstance(second, list) or ast.dump(first) == ast.dump(second):
                self.scope[name] = first
                continue
            variable = self.fresh(name)
            if dynamic or self.is_dynamic(first) or self.is_dynamic(second):
                self.dynamic.add(variable)
            taken[0].append(Assign(variable, first))
            other[0].append(Assign(variable, second))
            self.scope[name] = _name(variable)

    # expressions

    def expression(self, node: ast.expr, out: Statements) -> ast.expr:
        """The same value without branches, which go to `out` before it."""
        match node:
            case ast.Constant(value=bool() | int() | float() as value):
                return ast.Constant(float(value))
            case ast.Name(id=name):
                return self.look_up(node, name)
            case ast.Subscript(value=ast.Name() as vector, slice=index):
                return self.entry(vector, index)
            case ast.Attribute(value=ast.Name(id=module), attr=name) if self.source.constants.get(module) is math:
                return ast.Constant(self.number(node, getattr(math, name, None)))
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as sign, operand=operand):
                return _fold(ast.UnaryOp(sign, self.expression(operand, out)))
            case ast.BinOp(left=left, op=op, right=right) if isinstance(op, OPERATORS):
                return _fold(ast.BinOp(self.expression(left, out), op, self.expression(right, out)))
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return self.choose(test, body, orelse, out)
            case ast.Call(func=function, args=arguments, keywords=[]):
                return self.call(node, ast.unparse(function), arguments, out)
            case _:
                self.source.refuse(node, f"`{ast.unparse(node)}`", SUBSET)

    def look_up(self, node: ast.AST, name: str) -> ast.expr:
        value = self.scope.get(name)
        if isinstance(value, list):
            self.source.refuse(node, f"the vector `{name}` without an index", f"write {name}[i]")
        if value is None:
            return ast.Constant(self.number(node, self.source.constants.get(name)))
        return value

    def number(self, node: ast.AST, value: object) -> float:
        if not isinstance(value, int | float):
            self.source.refuse(node, f"`{ast.unparse(node)}`, which is not assigned on every path and no constant", SUBSET)
        return float(value)

    def entry(self, vector: ast.Name, index: ast.expr) -> ast.expr:
        position, length = self.integer(index), self.length(vector)
        if not -length <= position < length:
            self.source.refuse(vector, f"entry {position} of `{vector.id}`", f"it has {length} entries")
        entries = self.scope[vector.id]
        assert isinstance(entries, list)
        return entries[position]

    def length(self, vector: ast.expr) -> int:
        entries = self.scope.get(vector.id) if isinstance(vector, ast.Name) else None
        if not isinstance(entries, list):
            self.source.refuse(vector, f"`{ast.unparse(vector)}` used as a vector", "declare the parameter with vector=True")
        return len(entries)

    def integer(self, node: ast.expr) -> int:
        value = self.expression(node, [])
        number = value.value if isinstance(value, ast.Constant) else None
        if not isinstance(number, float) or not number.is_integer():
            self.source.refuse(node, f"the index `{ast.unparse(node)}`", "use whole numbers that do not depend on the state")
        return int(number)

    def choose(self, test: ast.expr, body: ast.expr, orelse: ast.expr, out: Statements) -> ast.expr:
        name = self.fresh("choice")

        def side(value: ast.expr) -> Filler:
            return lambda inner: self.bind(name, self.expression(value, inner), inner)

        self.fork(test, side(body), side(orelse), out)
        chosen = self.scope.pop(name)
        assert not isinstance(chosen, list)
        return chosen

    def call(self, node: ast.expr, function: str, arguments: list[ast.expr], out: Statements) -> ast.expr:
        if function in ("min", "max") and len(arguments) >= 2:
            return self.extreme(function, [self.expression(argument, out) for argument in arguments], node, out)
        if function == "len" and len(arguments) == 1:
            return ast.Constant(float(self.length(arguments[0])))
        values = [self.expression(argument, out) for argument in arguments]
        if function == "float" and len(values) == 1:
            return values[0]
        if function in ("abs", "math.fabs") and len(values) == 1:
            negative = _fold(ast.UnaryOp(ast.USub(), values[0]))
            return self.select(values[0], ast.GtE(), ast.Constant(0.0), (values[0], negative), node, out)
        name = function.removeprefix("math.")
        if name not in DERIVATIVES or len(values) != 1:
            self.source.refuse(node, f"`{ast.unparse(node)}`", f"{SUBSET}; of math: {', '.join(sorted(DERIVATIVES))}")
        return _fold(ast.Call(ast.Attribute(ast.Name("math", ast.Load()), name), values, []))

    def extreme(self, function: str, values: list[ast.expr], node: ast.expr, out: Statements) -> ast.expr:
        best, *others = values
        op = ast.GtE() if function == "max" else ast.LtE()
        for value in others:
            best = self.select(best, op, value, (best, value), node, out)
        return best

    def select(
        self, left: ast.expr, op: ast.cmpop, right: ast.expr, sides: tuple[ast.expr, ast.expr], node: ast.expr, out: Statements
    ) -> ast.expr:
        name = self.fresh("choice")
        bind = [lambda inner, value=value: self.bind(name, value, inner) for value in sides]
        self.compare(node, left, op, right, bind[0], bind[1], out)
        chosen = self.scope.pop(name)
        assert not isinstance(chosen, list)
        return chosen

    def is_dynamic(self, expression: ast.expr) -> bool:
        return not self.dynamic.isdisjoint(names_in(expression))


def _name(variable: str) -> ast.expr:
    return ast.Name(variable, ast.Load())


def _assign(target: ast.Name, value: ast.expr, node: ast.AST) -> ast.stmt:
    return ast.copy_location(ast.Assign([target], ast.copy_location(value, node)), node)


def _has_return(statement: ast.stmt) -> bool:
    return any(isinstance(node, ast.Return) for node in ast.walk(statement))


def _evaluate(expression: ast.expr) -> float:
    code = compile(ast.fix_missing_locations(ast.Expression(expression)), "<constant>", "eval")
    return float(eval(code, {"math": math}))


def _fold(expression: ast.expr) -> ast.expr:
    """The value of an expression of constants, else the expression."""
    if names_in(expression) - {"math"}:
        return expression
    try:
        return ast.Constant(_evaluate(expression))
    except (ArithmeticError, ValueError):
        return expression
