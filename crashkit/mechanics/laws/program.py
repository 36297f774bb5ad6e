"""A law as a short program that every emitter reads: single assignments, branches of one comparison, returns."""

import ast
from collections.abc import Mapping
from typing import TypeAlias

from attrs import frozen


@frozen
class Assign:
    """A variable, assigned once on every path."""

    target: str
    value: ast.expr


@frozen
class Branch:
    """A choice between two blocks.

    Arguments:
        test: the comparison.
        guard: an expression that is positive while the test holds; None where the test knows only parameters.
        bit: its bit in the mode; None where the test knows only parameters.
        body, orelse: the two blocks.
    """

    test: ast.expr
    guard: ast.expr | None
    bit: int | None
    body: "Block"
    orelse: "Block"


@frozen
class Return:
    """The value of the law; always the last statement of its path."""

    value: ast.expr


Block: TypeAlias = tuple[Assign | Branch | Return, ...]


@frozen
class Program:
    """A law for given vector lengths.

    Arguments:
        state: the variables that hold d, ddot, d_max and the memory.
        parameters: the variables that hold the parameters, one for each number.
        block: the statements.
        bits: how many branches depend on the state.
    """

    state: tuple[str, ...]
    parameters: tuple[str, ...]
    block: Block
    bits: int


def names_in(expression: ast.expr) -> set[str]:
    """The variables of an expression."""
    return {node.id for node in ast.walk(expression) if isinstance(node, ast.Name)}


def returns(block: Block) -> bool:
    """Whether every path through the block ends in a return."""
    if not block:
        return False
    last = block[-1]
    return isinstance(last, Return) or (isinstance(last, Branch) and returns(last.body) and returns(last.orelse))


Scope: TypeAlias = Mapping[str, ast.expr | list[ast.expr]]
"""What each name of the law's source stands for at one point: a variable, a constant, or a vector of variables."""
