"""From a law's program to the source of the functions that the engine calls.

`mode` says which branches a state takes, one bit each. `frozen` gives the value with the branches of a mode, whatever the
state, and the smallest guard: the signed distance of the taken branches' comparisons, negative once one of them no longer
holds; `distance` gives one of them. `partials` gives the frozen value and its derivatives to d, ddot, d_max, the memory and
every parameter, by going back through the statements. `guard`, only of a law that may jump, does the same for the smallest
guard.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from functools import cache

from crashkit.mechanics.laws.backward import go_back
from crashkit.mechanics.laws.lower import lower
from crashkit.mechanics.laws.own_branches import emit_own, has_own_branches
from crashkit.mechanics.laws.program import Assign, Block, Branch, Program, Return, text_of
from crashkit.mechanics.laws.source import LawFunction, OutsideSubset
from crashkit.mechanics.laws.text import indented, taken, when

Leaf = Callable[[Return], Iterable[str]]
Head = Callable[[Branch, bool], Iterable[str]]


@cache
def emit(function: LawFunction) -> str:
    """Source of `law_mode`, `law_frozen`, `law_distance`, `law_partials` and, if the law may jump, `law_guard`.

    Raises:
        CrashkitError: what a law declares and what its functions take do not agree; names law, line and remedy.
        OutsideSubset: the law can only run as plain Python.
    """
    if function.law.opaque:
        raise OutsideSubset(f"spring law {function.law.name}: declared opaque")
    if has_own_branches(function):
        return emit_own(function)
    program = lower(function)
    parts = [_mode, _frozen, _distance, _partials, *([_guard] if function.law.jumps else [])]
    return "\n\n".join(part(program) for part in parts)


@cache
def can_be_derived(function: LawFunction) -> bool:
    """Whether branches and sensitivities of a law follow from its source."""
    try:
        emit(function)
    except OutsideSubset:
        return False
    return True


def _mode(program: Program) -> str:
    def head(branch: Branch, side: bool) -> Iterator[str]:
        if branch.bit is not None and side:
            yield f"mode |= {1 << branch.bit}"

    body = _forward(program.tests, "live", head, lambda leaf: [])
    return _function(program, "law_mode", "p, o", ["mode = 0", *body, "return mode"])


def _frozen(program: Program) -> str:
    def head(branch: Branch, side: bool) -> Iterator[str]:
        if branch.guard is not None:
            yield f"guard = min(guard, {_guard_of(branch, side)})"

    body = _forward(program.block, "frozen", head, lambda leaf: [f"return {text_of(leaf.value)}, guard"])
    return _function(program, "law_frozen", "p, o", ["guard = math.inf", *body], "mode, ")


def _distance(program: Program) -> str:
    def head(branch: Branch, side: bool) -> Iterator[str]:
        if branch.guard is not None:
            yield f"if which == {branch.bit}: distance = {_guard_of(branch, side)}"

    body = _forward(program.tests, "frozen", head, lambda leaf: [])
    return _function(program, "law_distance", "p, o", ["distance = math.inf", *body, "return distance"], "which, mode, ")


def _partials(program: Program) -> str:
    forward = _forward(program.block, "frozen", lambda branch, side: [], lambda leaf: [f"value = {text_of(leaf.value)}"])
    known: set[str] = set()
    backward = go_back(program.block, known, lambda leaf: leaf.value, lambda branch: None)
    return _derivatives(program, "law_partials", [*forward, *backward], known, "value")


def _guard(program: Program) -> str:
    def head(branch: Branch, side: bool) -> Iterator[str]:
        if branch.guard is not None:
            yield f"distance = {_guard_of(branch, side)}"
            yield f"if distance < guard: guard = distance; nearest = {branch.bit}"

    known: set[str] = set()
    forward = ["guard = math.inf", "nearest = -1", *_forward(program.tests, "frozen", head, lambda leaf: [])]
    backward = go_back(program.tests, known, lambda leaf: None, lambda branch: branch.guard)
    return _derivatives(program, "law_guard", [*forward, *backward], known, "guard")


def _guard_of(branch: Branch, side: bool) -> str:
    return branch.distance if side else f"-({branch.distance})"


def _derivatives(program: Program, name: str, body: list[str], known: set[str], value: str) -> str:
    inputs = (*program.state, *program.parameters)
    store = [f"out[{i}] = {f'adjoint_{variable}' if variable in known else '0.0'}" for i, variable in enumerate(inputs)]
    return _function(program, name, "p, o, out", [*body, *store, f"return {value}"], "mode, ")


def _function(program: Program, name: str, last: str, body: list[str], first: str = "") -> str:
    used = set(re.findall(r"\w+", "\n".join(body)))
    reads = [f"{variable} = p[o + {index}]" for index, variable in enumerate(program.parameters) if variable in used]
    return "\n".join([f"def {name}({first}{', '.join(program.state)}, {last}):", *indented([*reads, *body])])


def _forward(block: Block, tests: str, head: Head, leaf: Leaf) -> list[str]:
    lines: list[str] = []
    for statement in block:
        if isinstance(statement, Assign):
            lines.append(statement.text)
        elif isinstance(statement, Return):
            lines += leaf(statement)
        else:
            body = [*head(statement, True), *_forward(statement.body, tests, head, leaf)]
            orelse = [*head(statement, False), *_forward(statement.orelse, tests, head, leaf)]
            lines += when(statement.comparison if tests == "live" else taken(statement), body, orelse)
    return lines
