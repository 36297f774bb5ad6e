"""Derivatives by going back through the statements of a law: adjoint_x is the derivative of the value to the variable x."""

import ast
from collections.abc import Callable, Iterator

from crashkit.mechanics.laws.functions import DERIVATIVES
from crashkit.mechanics.laws.program import Assign, Block, Branch, Return, assigned_in, names_in, text_of
from crashkit.mechanics.laws.text import taken, when

OfLeaf = Callable[[Return], ast.expr | None]
OfBranch = Callable[[Branch], ast.expr | None]


def go_back(block: Block, known: set[str], of_leaf: OfLeaf, of_branch: OfBranch) -> list[str]:
    """Lines that compute the adjoints of the variables of a block.

    Arguments:
        block: on the branches of a mode.
        known: variables whose adjoint has a value; those that get one are added.
        of_leaf: what of a return is to be differentiated, if anything.
        of_branch: what of a branch, if its guard is the nearest.
    """
    lines: list[str] = []
    for statement in reversed(block):
        if isinstance(statement, Branch):
            lines += _back_through(statement, known, of_leaf, of_branch)
        elif isinstance(statement, Assign):
            if statement.target in known:
                lines += _contributions(statement.value, f"adjoint_{statement.target}", known, statement.target)
        else:
            expression = of_leaf(statement)
            lines += _contributions(expression, "1.0", known) if expression is not None else []
    return lines


def _back_through(branch: Branch, known: set[str], of_leaf: OfLeaf, of_branch: OfBranch) -> list[str]:
    guard = of_branch(branch)
    outer = _read_in((branch,), of_leaf, of_branch) - {*assigned_in((branch,))}
    lines = [f"adjoint_{variable} = 0.0" for variable in sorted(outer - known)]
    known |= outer
    sides = [go_back(side, set(known), of_leaf, of_branch) for side in (branch.body, branch.orelse)]
    lines += when(taken(branch), *sides)
    if guard is not None and branch.bit is not None:
        side = f"(1.0 if mode & {1 << branch.bit} else -1.0)"
        lines += when(f"nearest == {branch.bit}", list(_contributions(guard, side, known)), [])
    return lines


def _read_in(block: Block, of_leaf: OfLeaf, of_branch: OfBranch) -> set[str]:
    """The variables to whose adjoints a block may contribute."""
    names: set[str] = set()
    for statement in block:
        if isinstance(statement, Branch):
            guard = of_branch(statement)
            names |= names_in(guard) if guard is not None else set()
            names |= _read_in(statement.body, of_leaf, of_branch) | _read_in(statement.orelse, of_leaf, of_branch)
        else:
            expression = statement.value if isinstance(statement, Assign) else of_leaf(statement)
            names |= names_in(expression) if expression is not None else set()
    return names


def _contributions(expression: ast.expr, seed: str, known: set[str], target: str = "") -> Iterator[str]:
    for variable, term in _pull(expression, seed, target):
        yield f"adjoint_{variable} {'+=' if variable in known else '='} {term}"
        known.add(variable)


def _pull(node: ast.expr, seed: str, target: str) -> Iterator[tuple[str, str]]:
    """The variables of an expression, each with the derivative of the expression times the seed."""
    match node:
        case ast.Name(id=name):
            yield name, seed
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield from _pull(operand, f"(-{seed})", target)
        case ast.BinOp(left=left, op=op, right=right):
            for side, slope in zip((left, right), _slopes(op, left, right), strict=True):
                if names_in(side):
                    yield from _pull(side, _times(seed, slope), target)
        case ast.Call(func=ast.Attribute(attr=name), args=[argument]):
            yield from _pull(argument, _times(seed, DERIVATIVES[name].format(x=text_of(argument), y=target)), target)


def _slopes(op: ast.operator, left: ast.expr, right: ast.expr) -> tuple[str, str]:
    """Derivatives of `left op right` to its two sides."""
    if isinstance(op, ast.Add | ast.Sub):
        return "1.0", "1.0" if isinstance(op, ast.Add) else "-1.0"
    a, b = text_of(left), text_of(right)
    match op:
        case ast.Mult():
            return b, a
        case ast.Div():
            return f"1.0 / {b}", f"-{a} / ({b} * {b})"
        case _:
            return _power(a, right), f"({a} ** {b} * math.log({a}) if {a} > 0.0 else 0.0)"


def _power(base: str, exponent: ast.expr) -> str:
    """The derivative of a power to its base."""
    match exponent:
        case ast.Constant(value=2.0):
            return f"2.0 * {base}"
        case ast.Constant(value=float() as number):
            return f"{number} * {base} ** {number - 1.0}"
        case _:
            return f"{text_of(exponent)} * {base} ** ({text_of(exponent)} - 1.0)"


def _times(seed: str, slope: str) -> str:
    return f"({slope})" if seed == "1.0" else seed if slope == "1.0" else f"({seed} * ({slope}))"
