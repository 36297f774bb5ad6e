"""A law as a short program that every emitter reads: single assignments, branches of one comparison, returns."""

import ast
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TypeAlias

from attrs import frozen


@frozen
class Assign:
    """A variable, assigned once on every path."""

    target: str
    value: ast.expr

    @cached_property
    def text(self) -> str:
        """The statement as source."""
        return f"{self.target} = {text_of(self.value)}"


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

    @cached_property
    def comparison(self) -> str:
        """The test as source."""
        return text_of(self.test)

    @cached_property
    def distance(self) -> str:
        """The guard as source."""
        assert self.guard is not None
        return text_of(self.guard)


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

    @cached_property
    def tests(self) -> Block:
        """What of the block decides which branches are taken."""
        return tests_of(self.block)[0]


Scope: TypeAlias = dict[str, ast.expr | list[ast.expr]]
"""What each name of the law's source stands for at one point: a variable, a constant, or a vector of variables."""


def names_in(expression: ast.expr) -> set[str]:
    """The variables of an expression of a program."""
    match expression:
        case ast.Name(id=name):
            return {name}
        case ast.UnaryOp(operand=operand):
            return names_in(operand)
        case ast.BinOp(left=left, right=right) | ast.Compare(left=left, comparators=[right]):
            return names_in(left) | names_in(right)
        case ast.Call(args=[argument]):
            return names_in(argument)
    return set()


def text_of(expression: ast.expr) -> str:
    """An expression as source; most are no more than a variable."""
    return expression.id if isinstance(expression, ast.Name) else ast.unparse(expression)


def returns(block: Sequence[Assign | Branch | Return]) -> bool:
    """Whether every path through the block ends in a return."""
    if not block:
        return False
    last = block[-1]
    return isinstance(last, Return) or (isinstance(last, Branch) and returns(last.body) and returns(last.orelse))


def leaves(block: Block) -> Iterator[Return]:
    """The returns of a block."""
    for statement in block:
        if isinstance(statement, Return):
            yield statement
        elif isinstance(statement, Branch):
            yield from leaves(statement.body)
            yield from leaves(statement.orelse)


def assigned_to(variable: str, block: Block) -> Block:
    """The block with each return made an assignment."""
    return tuple(_assigned(variable, statement) for statement in block)


def _assigned(variable: str, statement: Assign | Branch | Return) -> Assign | Branch:
    if isinstance(statement, Return):
        return Assign(variable, statement.value)
    if isinstance(statement, Branch):
        body, orelse = assigned_to(variable, statement.body), assigned_to(variable, statement.orelse)
        return Branch(statement.test, statement.guard, statement.bit, body, orelse)
    return statement


def assigned_in(block: Block) -> Iterator[str]:
    """The variables that a block assigns."""
    for statement in block:
        if isinstance(statement, Assign):
            yield statement.target
        elif isinstance(statement, Branch):
            yield from assigned_in(statement.body)
            yield from assigned_in(statement.orelse)


def tests_of(block: Block, wanted: frozenset[str] = frozenset()) -> tuple[Block, frozenset[str]]:
    """What of a block decides which branches are taken, or gives the variables wanted; with the variables that it reads."""
    kept: list[Assign | Branch | Return] = []
    for statement in reversed(block):
        if isinstance(statement, Assign) and statement.target in wanted:
            wanted |= names_in(statement.value)
            kept.append(statement)
        elif isinstance(statement, Branch):
            body, first = tests_of(statement.body, wanted)
            orelse, second = tests_of(statement.orelse, wanted)
            if body or orelse or statement.bit is not None:
                wanted = first | second | names_in(statement.test)
                kept.append(Branch(statement.test, statement.guard, statement.bit, body, orelse))
    return tuple(reversed(kept)), wanted
