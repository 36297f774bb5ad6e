"""The source of a spring law: one pure scalar function, and the functions that it calls, as syntax trees."""

import ast
import inspect
import textwrap
from collections import ChainMap
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NoReturn

from attrs import frozen

from crashkit.errors import CrashkitError
from crashkit.protocols import SpringLaw

STATE = ("d", "ddot", "d_max")
"""The first three arguments of every law; one with memory has its memory as the fourth."""


class OutsideSubset(CrashkitError):
    """Something that cannot be derived from a law's source."""


@frozen
class LawFunction:
    """A law or factor with the lengths of its vector parameters: what the engine compiles one function for.

    Arguments:
        law: the plugin's class.
        sizes: length of each vector parameter, in the order of declaration.
        part: "force", or "memory_rate" for the function that says how the law's memory changes.
    """

    law: type[SpringLaw]
    sizes: tuple[int, ...] = ()
    part: str = "force"

    def lengths(self) -> dict[str, int]:
        """Length of each vector parameter by name."""
        vectors = [spec.name for spec in self.law.parameters if spec.vector]
        return dict(zip(vectors, self.sizes, strict=True))

    def count(self) -> int:
        """How many numbers the law's parameters are."""
        lengths = self.lengths()
        return sum(lengths.get(spec.name, 1) for spec in self.law.parameters)


@frozen
class LawSource:
    """A parsed function of a law, and what is needed to say where something in it is wrong.

    Arguments:
        name: of the law.
        file, first_line: where the function stands.
        tree: of the function.
        constants: the names that its module holds.
    """

    name: str
    file: str
    first_line: int
    tree: ast.FunctionDef
    constants: Mapping[str, Any]

    @property
    def arguments(self) -> list[str]:
        """The names of the function's arguments."""
        return [argument.arg for argument in self.tree.args.args]

    def refuse(self, node: ast.AST | None, found: str, remedy: str) -> NoReturn:
        """Raise the error that names the law, the line and the remedy."""
        line = self.first_line + getattr(node, "lineno", 1) - 1
        raise OutsideSubset(f"spring law {self.name} ({self.file}:{line}): found {found}; {remedy}")


def state_of(law: type[SpringLaw]) -> tuple[str, ...]:
    """The names of a law's arguments before its parameters."""
    return (*STATE, law.memory) if law.memory else STATE


def read_law(
    law: type[SpringLaw], part: str = "force", before: tuple[str, ...] = (), after: tuple[str, ...] = ()
) -> LawSource:
    """The source of a function of a law.

    Arguments:
        law: the plugin's class.
        part: the name of the function.
        before, after: its arguments beside those of `force`.

    Raises:
        CrashkitError: its arguments are not the declared ones.
        OutsideSubset: it cannot be read.
    """
    source = read_function(law.name, part, getattr(law, part))
    expected = [*before, *state_of(law), *(spec.name for spec in law.parameters), *after]
    if source.arguments != expected:
        raise CrashkitError(
            f"spring law {law.name} ({source.file}:{source.first_line}): "
            f"expected {part} to take {', '.join(expected)}, found {', '.join(source.arguments)}"
        )
    return source


def read_function(law: str, part: str, function: Callable[..., Any]) -> LawSource:
    """The source of a function that is, or is called by, the part of a law; raises OutsideSubset where it has none."""
    try:
        tree, file, first_line = _parsed(function)
    except (OSError, TypeError, SyntaxError) as error:
        raise OutsideSubset(
            f"spring law {law}: its {part} has no source that can be read ({error}); define it with def, in a file"
        ) from error
    if not isinstance(tree, ast.FunctionDef):
        raise OutsideSubset(f"spring law {law} ({file}:{first_line}): expected {part} to be a function defined with def")
    enclosing = inspect.getclosurevars(function).nonlocals
    return LawSource(law, file, first_line, tree, ChainMap(dict(enclosing), function.__globals__))


@cache
def _parsed(function: Callable[..., Any]) -> tuple[ast.stmt, str, int]:
    """The syntax tree of a function, which nobody may change for several laws may call it; its file and its first line."""
    if getattr(getattr(function, "__code__", None), "co_filename", "") == "<string>":
        raise OSError("it is not in a file")  # Python 3.13 would lend it the text of another string that was run
    lines, first_line = inspect.getsourcelines(function)
    return ast.parse(textwrap.dedent("".join(lines))).body[0], inspect.getsourcefile(function) or "?", first_line
