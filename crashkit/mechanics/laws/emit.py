"""From a law's program to the source of the functions that the engine calls.

`mode` says which branches a state takes, one bit each. `frozen` gives the value with the branches of a mode, whatever the
state, and the smallest guard: the signed distance of the taken branches' comparisons, negative once one of them no longer
holds. `partials` gives the frozen value and its derivatives to d, ddot, d_max, the memory and every parameter, by going back
through the statements. `guard`, only of a law that may jump, does the same for the smallest guard.
"""

import ast
from collections.abc import Callable, Iterable, Iterator

from crashkit.mechanics.laws.functions import DERIVATIVES
from crashkit.mechanics.laws.source import LawFunction
from crashkit.mechanics.laws.lower import lower
from crashkit.mechanics.laws.program import Assign, Block, Branch, Program, Return, names_in

Leaf = Callable[[Return], Iterable[str]]
Head = Callable[[Branch, bool], Iterable[str]]

DECORATOR = "@compiled"


def emit(function: LawFunction, name: str) -> str:
    """Source of `name_mode`, `name_frozen`, `name_partials` and, if the law may jump, `name_guard`."""
    program = lower(function)
    parts = [_mode, _frozen, _partials, *([_guard] if function.law.jumps else [])]
    return "\n\n".join(part(program, name) for part in parts)


def _mode(program: Program, name: str) -> str:
    def head(branch: Branch, taken: bool) -> Iterator[str]:
        if branch.bit is not None and taken:
            yield f"mode |= {1 << branch.bit}"

    body = _forward(program.block, "live", head, lambda leaf: ["return mode"])
    return _function(program, f"{name}_mode", "p, o", ["mode = 0", *body])


def _frozen(program: Program, name: str) -> str:
    def head(branch: Branch, taken: bool) -> Iterator[str]:
        if branch.guard is not None:
            sign = "" if taken else "-"
            yield f"guard = min(guard, {sign}({ast.unparse(branch.guard)}))"

    body = _forward(program.block, "frozen", head, lambda leaf: [f"return {ast.unparse(leaf.value)}, guard"])
    return _function(program, f"{name}_frozen", "p, o", ["guard = math.inf", *body], "mode, ")


def _partials(program: Program, name: str) -> str:
    forward = _forward(program.block, "frozen", lambda branch, taken: [], lambda leaf: [f"value = {ast.unparse(leaf.value)}"])
    backward = _backward(program.block, lambda leaf: _contributions(leaf.value, "1.0"), lambda branch: [])
    return _derivatives(program, f"{name}_partials", forward, backward, "value")


def _guard(program: Program, name: str) -> str:
    def head(branch: Branch, taken: bool) -> Iterator[str]:
        if branch.guard is not None:
            yield f"distance = {'' if taken else '-'}({ast.unparse(branch.guard)})"
            yield f"if distance < guard: guard, nearest = distance, {branch.bit}"

    def contributions(branch: Branch) -> list[str]:
        if branch.guard is None or branch.bit is None:
            return []
        side = f"(1.0 if mode & {1 << branch.bit} else -1.0)"
        return _if(f"nearest == {branch.bit}", _contributions(branch.guard, side), [])

    forward = ["guard, nearest = math.inf, -1", *_forward(program.block, "frozen", head, lambda leaf: ["pass"])]
    return _derivatives(program, f"{name}_guard", forward, _backward(program.block, lambda leaf: [], contributions), "guard")


def _derivatives(program: Program, name: str, forward: list[str], backward: list[str], value: str) -> str:
    inputs = [*program.state, *program.parameters]
    adjoints = [f"adjoint_{variable} = 0.0" for variable in sorted({*inputs, *_assigned(program.block)})]
    store = [f"out[{index}] = adjoint_{variable}" for index, variable in enumerate(inputs)]
    return _function(program, name, "p, o, out", [*adjoints, *forward, *backward, *store, f"return {value}"], "mode, ")


def _function(program: Program, name: str, last: str, body: list[str], first: str = "") -> str:
    used = set().union(*(line.replace("(", " ").replace(")", " ").replace(",", " ").split() for line in body))
    reads = [f"{variable} = p[o + {index}]" for index, variable in enumerate(program.parameters) if variable in used]
    lines = [f"    {line}" for line in (*reads, *body)]
    return "\n".join([DECORATOR, f"def {name}({first}{', '.join(program.state)}, {last}):", *lines])


def _forward(block: Block, tests: str, head: Head, leaf: Leaf) -> list[str]:
    lines: list[str] = []
    for statement in block:
        if isinstance(statement, Assign):
            lines.append(f"{statement.target} = {ast.unparse(statement.value)}")
        elif isinstance(statement, Return):
            lines += leaf(statement)
        else:
            body = [*head(statement, True), *_forward(statement.body, tests, head, leaf)]
            orelse = [*head(statement, False), *_forward(statement.orelse, tests, head, leaf)]
            lines += _if(_test(statement, tests), body, orelse)
    return lines


def _test(branch: Branch, tests: str) -> str:
    if branch.bit is None or tests == "live":
        return ast.unparse(branch.test)
    return f"mode & {1 << branch.bit}"


def _if(test: str, body: list[str], orelse: list[str]) -> list[str]:
    lines = [f"if {test}:", *_indented(body or ["pass"])]
    return [*lines, "else:", *_indented(orelse)] if orelse else lines


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"    {line}" for line in lines]


def _assigned(block: Block) -> Iterator[str]:
    for statement in block:
        if isinstance(statement, Assign):
            yield statement.target
        elif isinstance(statement, Branch):
            yield from _assigned(statement.body)
            yield from _assigned(statement.orelse)


def _backward(block: Block, leaf: Leaf, guard: Callable[[Branch], list[str]]) -> list[str]:
    lines: list[str] = []
    for statement in reversed(block):
        if isinstance(statement, Branch):
            body, orelse = _backward(statement.body, leaf, guard), _backward(statement.orelse, leaf, guard)
            lines += [*_if(_test(statement, "frozen"), body, orelse), *guard(statement)]
        elif isinstance(statement, Return):
            lines += leaf(statement)
        else:
            lines += _contributions(statement.value, f"adjoint_{statement.target}")
    return lines


def _contributions(expression: ast.expr, seed: str) -> list[str]:
    return [f"adjoint_{variable} += {term}" for variable, term in _pull(expression, seed)]


def _pull(node: ast.expr, seed: str) -> Iterator[tuple[str, str]]:
    """The variables of an expression, each with the derivative of the expression times the seed."""
    if not names_in(node):
        return
    match node:
        case ast.Name(id=name):
            yield name, seed
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            yield from _pull(operand, f"(-{seed})")
        case ast.UnaryOp(operand=operand):
            yield from _pull(operand, seed)
        case ast.BinOp(left=left, op=op, right=right):
            first, second = _slopes(op, f"({ast.unparse(left)})", f"({ast.unparse(right)})")
            yield from _pull(left, _times(seed, first))
            yield from _pull(right, _times(seed, second))
        case ast.Call(func=ast.Attribute(attr=name), args=[argument]):
            yield from _pull(argument, _times(seed, DERIVATIVES[name].format(x=f"({ast.unparse(argument)})")))


def _slopes(op: ast.operator, left: str, right: str) -> tuple[str, str]:
    """Derivatives of `left op right` to its two sides."""
    match op:
        case ast.Add():
            return "1.0", "1.0"
        case ast.Sub():
            return "1.0", "-1.0"
        case ast.Mult():
            return right, left
        case ast.Div():
            return f"1.0 / {right}", f"-{left} / ({right} * {right})"
        case _:
            return f"{right} * {left} ** ({right} - 1.0)", f"power_slope({left}, {right})"


def _times(seed: str, slope: str) -> str:
    return f"({slope})" if seed == "1.0" else seed if slope == "1.0" else f"({seed} * ({slope}))"
