"""Functions that are written for the compiler, as text to paste: with their constants and the functions that they call."""

import ast
import builtins
import copy
import math
from collections.abc import Callable
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from crashkit.mechanics.laws.source import LawSource, read_function

MODULES = {"math": math, "np": np}
"""What pasted text can call by these names."""
KEPT = ("abs", "bool", "enumerate", "float", "int", "len", "max", "min", "range", "round", "sum", "zip")


def paste(law: str, function: Callable[..., Any], name: str) -> str:
    """The text of a function under a name of its own, behind that of every function it calls.

    Raises:
        OutsideSubset: it uses something that is neither a number, nor one of `math` or numpy, nor a function with source.
    """
    return "\n\n".join(_Texts(law).add(_plain(function), name).values())


class _Texts(dict[FunctionType, str]):
    """The text of each function, in the order in which they are to be pasted."""

    def __init__(self, law: str) -> None:
        super().__init__()
        self.law = law
        self.names: dict[FunctionType, str] = {}

    def add(self, function: FunctionType, name: str) -> "_Texts":
        """Add a function and what it calls."""
        self.names[function] = name
        source = read_function(self.law, function.__name__, function)
        tree = copy.deepcopy(source.tree)
        tree.name, tree.decorator_list, tree.returns = name, [], None
        tree = _Linked(source, lambda other: self.name_of(other, f"{name}_{other.__name__}")).visit(tree)
        tree.decorator_list = [ast.Name("jitted", ast.Load())]
        self[function] = ast.unparse(ast.fix_missing_locations(tree))
        return self

    def name_of(self, function: FunctionType, name: str) -> str:
        """The name under which a function is pasted, now if not yet."""
        if function not in self.names:
            self.add(function, name)
        return self.names[function]


class _Linked(ast.NodeTransformer):
    """Puts numbers in place of the constants of a module, and pasted names in place of its functions."""

    def __init__(self, source: LawSource, called: Callable[[FunctionType], str]) -> None:
        self.source = source
        self.called = called
        stored = {node.id for node in ast.walk(source.tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
        self.own = {*source.arguments, *stored}

    def visit_arg(self, node: ast.arg) -> ast.arg:
        return ast.arg(node.arg)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST:
        assert node.value is not None
        return ast.copy_location(ast.Assign([node.target], self.visit(node.value)), node)

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id in self.own:
            return node
        return self.linked(node, self.source.constants.get(node.id, getattr(builtins, node.id, None)))

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        if isinstance(node.value, ast.Name) and node.value.id not in self.own:
            found = self.source.constants.get(node.value.id)
            names = [name for name, module in MODULES.items() if module is found]
            if names:
                return ast.Attribute(ast.Name(names[0], ast.Load()), node.attr, ast.Load())
            if isinstance(found, ModuleType | type):
                return self.linked(node, getattr(found, node.attr, None))
        return ast.Attribute(self.visit(node.value), node.attr, node.ctx)

    def linked(self, node: ast.expr, found: object) -> ast.expr:
        if isinstance(found, bool | int | float):
            return ast.Constant(found)
        if isinstance(found, FunctionType) or hasattr(found, "py_func"):
            return ast.Name(self.called(_plain(found)), ast.Load())
        if isinstance(node, ast.Name) and node.id in KEPT:
            return node
        remedy = "use numbers, math, numpy as it is, and functions that do the same"
        self.source.refuse(node, f"`{ast.unparse(node)}`", remedy)


def _plain(function: Any) -> FunctionType:
    """The function itself, where numba compiles it already."""
    return getattr(function, "py_func", function)
