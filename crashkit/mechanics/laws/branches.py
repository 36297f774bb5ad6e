"""Branches: every test of the state becomes one comparison with a bit of its own, and its two sides meet again."""

import ast
from abc import ABC, abstractmethod
from collections.abc import Callable

from crashkit.mechanics.laws.fold import evaluated, folded
from crashkit.mechanics.laws.program import Assign, Branch, Return, Scope, names_in, returns, text_of
from crashkit.mechanics.laws.source import LawSource

GREATER = (ast.Gt, ast.GtE)
LESS = (ast.Lt, ast.LtE)

Statements = list[Assign | Branch | Return]
Filler = Callable[[Statements], None]


class Branches(ABC):
    """What names stand for, and which of them depend on the state, while a law is read from top to bottom."""

    def __init__(self, source: LawSource) -> None:
        self.source = source
        self.scope: Scope = {}
        self.dynamic: set[str] = set()
        self.variables = 0
        self.bits = 0

    @abstractmethod
    def expression(self, node: ast.expr, out: Statements) -> ast.expr:
        """The same value without branches, which go to `out` before it."""

    def fresh(self, name: str) -> str:
        """A variable that nothing else is called."""
        self.variables += 1
        return f"{name}_{self.variables}"

    def bind(self, name: str, value: ast.expr, out: Statements) -> None:
        """Let a name stand for a value from here on."""
        self.scope[name] = self.named(value, out, name)

    def named(self, value: ast.expr, out: Statements, name: str = "part") -> ast.expr:
        """A variable or constant of this value, so that what reads it twice computes it once."""
        if isinstance(value, ast.Name | ast.Constant):
            return value
        variable = self.fresh(name)
        if self.is_dynamic(value):
            self.dynamic.add(variable)
        out.append(Assign(variable, value))
        return name_of(variable)

    def is_dynamic(self, expression: ast.expr) -> bool:
        """Whether a value depends on the state."""
        return not self.dynamic.isdisjoint(names_in(expression))

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
            (body if evaluated(test) else orelse)(out)
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
            return folded(ast.BinOp(left, ast.Sub(), right))
        if isinstance(op, LESS):
            return folded(ast.BinOp(right, ast.Sub(), left))
        self.source.refuse(node, "a state compared for equality", "compare with <, <=, > or >=")

    def side(self, fill: Filler, before: Scope) -> tuple[Statements, Scope]:
        out: Statements = []
        self.scope = dict(before)
        fill(out)
        return out, self.scope

    def merge(self, before: Scope, taken: tuple[Statements, Scope], other: tuple[Statements, Scope], dynamic: bool) -> None:
        """Give each name that the two sides leave with different values one variable that both assign."""
        self.scope = dict(before)
        sides = [side for side in (taken, other) if not returns(side[0])]
        if len(sides) == 1:
            self.scope = sides[0][1]
        if len(sides) < 2:
            return
        for name in (name for name in taken[1] if name in other[1]):
            first, second = taken[1][name], other[1][name]
            if isinstance(first, list) or isinstance(second, list) or first is second or text_of(first) == text_of(second):
                self.scope[name] = first
                continue
            variable = self.fresh(name)
            if dynamic or self.is_dynamic(first) or self.is_dynamic(second):
                self.dynamic.add(variable)
            for (statements, scope), value in ((taken, first), (other, second)):
                _hand_over(statements, scope, name, variable, value)
            self.scope[name] = name_of(variable)

    def choose(self, test: ast.expr, body: ast.expr, orelse: ast.expr, out: Statements) -> ast.expr:
        name = self.fresh("choice")

        def side(value: ast.expr) -> Filler:
            return lambda inner: self.bind(name, self.expression(value, inner), inner)

        self.fork(test, side(body), side(orelse), out)
        chosen = self.scope.pop(name)
        assert not isinstance(chosen, list)
        return chosen

    def extreme(self, function: str, values: list[ast.expr], node: ast.expr, out: Statements) -> ast.expr:
        best, *others = (self.named(value, out) for value in values)
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


def name_of(variable: str) -> ast.expr:
    """An expression that reads a variable."""
    return ast.Name(variable, ast.Load())


def _hand_over(statements: Statements, scope: Scope, name: str, variable: str, value: ast.expr) -> None:
    """Let a variable take over the value that a name has at the end of a side."""
    last = statements[-1] if statements else None
    others = (other for key, other in scope.items() if key != name)
    if isinstance(last, Assign) and isinstance(value, ast.Name) and last.target == value.id and value not in others:
        statements[-1] = Assign(variable, last.value)
    else:
        statements.append(Assign(variable, value))
