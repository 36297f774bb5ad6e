"""A spring law's source: one pure scalar function, read as a syntax tree."""

import ast
import inspect
import textwrap
from collections.abc import Mapping
from typing import NoReturn

from attrs import frozen

from crashkit.errors import CrashkitError
from crashkit.protocols import SpringLaw

STATE = ("d", "ddot", "d_max")
"""The first three arguments of every law; one with memory has its memory as the fourth."""


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
    """The parsed function of a law, and what is needed to say where something in it is wrong."""

    name: str
    file: str
    first_line: int
    tree: ast.FunctionDef
    constants: Mapping[str, object]

    def refuse(self, node: ast.AST | None, found: str, remedy: str) -> NoReturn:
        """Raise the error that names the law, the line and the remedy."""
        line = self.first_line + getattr(node, "lineno", 1) - 1
        raise CrashkitError(f"spring law {self.name} ({self.file}:{line}): found {found}; {remedy}")


def state_of(law: type[SpringLaw]) -> tuple[str, ...]:
    """The names of a law's arguments before its parameters."""
    return (*STATE, law.memory) if law.memory else STATE


def read_law(law: type[SpringLaw], part: str = "force") -> LawSource:
    """The source of a law; raises CrashkitError where it cannot be read or its arguments are not the declared ones."""
    function = getattr(law, part)
    try:
        lines, first_line = inspect.getsourcelines(function)
        file = inspect.getsourcefile(function) or "?"
        tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
    except (OSError, TypeError, SyntaxError) as error:
        raise CrashkitError(
            f"spring law {law.name}: its {part} has no source that can be read ({error}); define it with def, in a file"
        ) from error
    if not isinstance(tree, ast.FunctionDef):
        raise CrashkitError(f"spring law {law.name} ({file}:{first_line}): expected {part} to be a function defined with def")
    source = LawSource(law.name, file, first_line, tree, function.__globals__)
    expected = [*state_of(law), *(spec.name for spec in law.parameters)]
    found = [argument.arg for argument in tree.args.args]
    if found != expected:
        source.refuse(tree, f"arguments {', '.join(found)}", f"expected {', '.join(expected)}")
    return source
