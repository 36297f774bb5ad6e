"""From the syntax tree of a law to its program: loops unrolled, functions pasted, min, max and abs made branches."""

import ast
import builtins
import math
from collections.abc import Iterator, Sequence
from types import FunctionType

from crashkit.mechanics.laws.branches import Branches, Filler, Statements, name_of
from crashkit.mechanics.laws.fold import folded
from crashkit.mechanics.laws.functions import DERIVATIVES, NAMES
from crashkit.mechanics.laws.program import Block, Program, Return, assigned_to, leaves, returns
from crashkit.mechanics.laws.source import LawFunction, LawSource, read_function, read_law, state_of

MAX_BITS = 62
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow)
SUBSET = "use assignments, if, min, max, abs, arithmetic, functions of math and loops over vector parameters"


def lower(function: LawFunction) -> Program:
    """The program of a law; raises OutsideSubset, naming law, line and remedy, for what a law may not contain."""
    return _Lowering(read_law(function.law, function.part)).program(function)


class _Lowering(Branches):
    def __init__(self, source: LawSource) -> None:
        super().__init__(source)
        self.pasted: list[FunctionType] = []

    def program(self, function: LawFunction) -> Program:
        names = state_of(function.law)
        state = tuple(self.fresh(name) for name in (*names, "memory")[:4])
        self.dynamic.update(state)
        self.scope.update(zip(names, map(name_of, state), strict=False))
        lengths = function.lengths()
        parameters: list[str] = []
        for spec in function.law.parameters:
            variables = [self.fresh(spec.name) for _ in range(lengths.get(spec.name, 1))]
            entries = [name_of(variable) for variable in variables]
            self.scope[spec.name] = list(entries) if spec.vector else entries[0]
            parameters += variables
        block = self.body(self.source)
        if self.bits > MAX_BITS:
            self.source.refuse(self.source.tree, f"{self.bits} branches", f"at most {MAX_BITS} are possible: use fewer knots")
        return Program(state, tuple(parameters), block, self.bits)

    def body(self, source: LawSource) -> Block:
        block = self.block(source.tree.body)
        if not returns(block):
            source.refuse(source.tree, "a path without return", "return a value on every path")
        return block

    # statements

    def block(self, statements: Sequence[ast.stmt]) -> Block:
        out: Statements = []
        pending = list(statements)
        while pending and not returns(out):
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

    def bind_all(self, statement: ast.stmt, names: list[ast.expr], values: list[ast.expr], out: Statements) -> None:
        for name, value in zip(names, values, strict=True):
            if not isinstance(name, ast.Name):
                self.source.refuse(statement, f"`{ast.unparse(statement)}`", SUBSET)
            self.bind(name.id, value, out)

    def unrolled(self, loop: ast.For) -> Iterator[ast.stmt]:
        for values in self.rounds(loop):
            targets = loop.target.elts if isinstance(loop.target, ast.Tuple) else [loop.target]
            for target, value in zip(targets, values, strict=True):
                yield ast.copy_location(ast.Assign([target], ast.copy_location(value, loop)), loop)
            yield from loop.body

    def rounds(self, loop: ast.For) -> Iterator[Sequence[ast.expr]]:
        """What the targets of a loop are in each of its rounds."""
        match loop.iter, loop.target:
            case ast.Call(func=ast.Name(id="range"), args=limits), ast.Name():
                yield from ([ast.Constant(i)] for i in range(*(self.integer(limit) for limit in limits)))
            case ast.Name() as vector, ast.Name():
                yield from ([ast.Subscript(vector, ast.Constant(i))] for i in range(self.length(vector)))
            case ast.Call(func=ast.Name(id="enumerate"), args=[vector]), ast.Tuple(elts=[_, _]):
                for i in range(self.length(vector)):
                    yield [ast.Constant(i), ast.Subscript(vector, ast.Constant(i))]
            case ast.Call(func=ast.Name(id="zip"), args=vectors), ast.Tuple(elts=targets) if len(vectors) == len(targets):
                for i in range(min(map(self.length, vectors))):
                    yield [ast.Subscript(vector, ast.Constant(i)) for vector in vectors]
            case _:
                found = f"`for {ast.unparse(loop.target)} in {ast.unparse(loop.iter)}`"
                self.source.refuse(loop, found, "loop over a vector, range(...), enumerate(vector) or zip(vector, vector)")

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
                return folded(ast.UnaryOp(sign, self.expression(operand, out)))
            case ast.BinOp(left=left, op=op, right=right) if isinstance(op, OPERATORS):
                values = self.expression(left, out), self.expression(right, out)
                if not isinstance(op, ast.Add | ast.Sub):
                    values = self.named(values[0], out), self.named(values[1], out)
                return folded(ast.BinOp(values[0], op, values[1]))
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return self.choose(test, body, orelse, out)
            case ast.Call(func=function, args=arguments, keywords=[]):
                return self.call(node, self.called(function), arguments, out)
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

    # calls

    def called(self, function: ast.expr) -> object:
        """The object that is called, or None."""
        match function:
            case ast.Name(id=name):
                return self.source.constants.get(name, getattr(builtins, name, None))
            case ast.Attribute(value=ast.Name(id=module), attr=name):
                return getattr(self.source.constants.get(module), name, None)
        return None

    def call(self, node: ast.Call, function: object, arguments: list[ast.expr], out: Statements) -> ast.expr:
        if isinstance(function, FunctionType):
            return self.paste(node, function, arguments, out)
        name = NAMES.get(function) if callable(function) else None
        if name == "len" and len(arguments) == 1:
            return ast.Constant(float(self.length(arguments[0])))
        values = [self.expression(argument, out) for argument in arguments]
        if name in ("min", "max") and len(values) >= 2:
            return self.extreme(name, values, node, out)
        if name == "float" and len(values) == 1:
            return values[0]
        if name == "abs" and len(values) == 1:
            value = self.named(values[0], out)
            negative = folded(ast.UnaryOp(ast.USub(), value))
            return self.select(value, ast.GtE(), ast.Constant(0.0), (value, negative), node, out)
        if name not in DERIVATIVES or len(values) != 1:
            self.source.refuse(node, f"`{ast.unparse(node)}`", f"{SUBSET}; of math: {', '.join(sorted(DERIVATIVES))}")
        argument = self.named(values[0], out)
        return self.named(folded(ast.Call(ast.Attribute(name_of("math"), name, ast.Load()), [argument], [])), out)

    def paste(self, node: ast.Call, function: FunctionType, arguments: list[ast.expr], out: Statements) -> ast.expr:
        """The value of a function of the author's own, whose statements go to `out`."""
        if function in self.pasted:
            self.source.refuse(node, f"`{ast.unparse(node)}`, a function that calls itself", SUBSET)
        source = read_function(self.source.name, function.__name__, function)
        if len(source.arguments) != len(arguments):
            self.source.refuse(node, f"`{ast.unparse(node)}`", f"expected {', '.join(source.arguments)} as its arguments")
        values = [self.argument(argument, out) for argument in arguments]
        caller = self.source, self.scope
        self.source, self.scope = source, dict(zip(source.arguments, values, strict=True))
        self.pasted.append(function)
        bits, block = self.bits, self.body(source)
        self.pasted.pop()
        self.source, self.scope = caller
        result = self.fresh(function.__name__)
        if self.bits > bits or any(self.is_dynamic(leaf.value) for leaf in leaves(block)):
            self.dynamic.add(result)
        out += assigned_to(result, block)
        return name_of(result)

    def argument(self, node: ast.expr, out: Statements) -> ast.expr | list[ast.expr]:
        vector = self.scope.get(node.id) if isinstance(node, ast.Name) else None
        return vector if isinstance(vector, list) else self.named(self.expression(node, out), out)


def _has_return(statement: ast.stmt) -> bool:
    within = [*getattr(statement, "body", []), *getattr(statement, "orelse", [])]
    return isinstance(statement, ast.Return) or any(map(_has_return, within))
