"""The installed spring laws by name, and their sums: "crush_plateau + peak" is a plateau with a peak on its loading curve."""

import ast
import builtins
import inspect
import linecache
import textwrap
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from crashkit.protocols import SpringLaw

HOOK = "added = 0.0"
"""The statement after which a law lets other curves be added to its loading curve, at the deformation that it calls `turn`."""


class LawBook(Mapping[str, type[SpringLaw]]):
    """Laws and factors by name; a name such as "a + b" is law a with b added to its loading curve.

    What is added takes part in unloading and in the rate factor of the first law, which a second joint beside it would not.
    The first law must hold the statement `added = 0.0` after it has set `turn`; what is added must end in its only `return`.
    """

    def __init__(self, laws: Mapping[str, type[SpringLaw]]) -> None:
        self._laws = dict(laws)

    def __getitem__(self, name: str) -> type[SpringLaw]:
        if name in self._laws:
            return self._laws[name]
        first, plus, added = name.rpartition(" + ")
        if not plus or not fit_together(self[first], self[added]):
            raise KeyError(name)
        return _sum(self[first], self[added])

    def __iter__(self) -> Iterator[str]:
        return iter(self._laws)

    def __len__(self) -> int:
        return len(self._laws)


def fit_together(first: type[SpringLaw], added: type[SpringLaw]) -> bool:
    """Whether the second law can be added to the loading curve of the first."""
    shared = {spec.name for spec in first.parameters} & {spec.name for spec in added.parameters}
    return can_take(first) and can_be_added(added) and not shared


def can_take(law: type[SpringLaw]) -> bool:
    """Whether other curves can be added to the law's loading curve."""
    return law.unit == "N" and any(ast.unparse(node) == HOOK for node in _tree(law).body)


def can_be_added(law: type[SpringLaw]) -> bool:
    """Whether the law can stand in another's loading curve."""
    tree = _tree(law)
    single = sum(isinstance(node, ast.Return) for node in ast.walk(tree)) == 1
    return law.unit == "N" and single and isinstance(tree.body[-1], ast.Return)


@cache
def _sum(first: type[SpringLaw], added: type[SpringLaw]) -> type[SpringLaw]:
    """One law whose loading curve is the sum, written out as source so that the engine can read it like any other."""
    name = f"{first.name} + {added.name}"
    tree, other = _tree(first), _tree(added)
    taken = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    renamed = _Renamed({a.arg for a in other.args.args[3:]}, {*added.force.__globals__, *dir(builtins)}, taken)
    body = [renamed.visit(node) for node in other.body if not _is_docstring(node)]
    total = ast.parse(f"added = added + ({ast.unparse(body.pop().value)})").body
    place = next(i for i, node in enumerate(tree.body) if ast.unparse(node) == HOOK) + 1
    tree.body[place:place] = [*body, *total]
    tree.args.args += other.args.args[3:]
    tree.decorator_list = []
    force = _function(f"<spring law {name}>", tree, {**added.force.__globals__, **first.force.__globals__})
    return type(
        "".join(part.title() for part in name.replace(" + ", "_").split("_")),
        (SpringLaw,),
        {
            "__doc__": f"{first.name} with {added.name} added to its loading curve.",
            "name": name,
            "unit": first.unit,
            "parameters": (*first.parameters, *added.parameters),
            "passive": first.passive and added.passive,
            "force": staticmethod(force),
        },
    )


def _tree(law: type[SpringLaw]) -> ast.FunctionDef:
    tree = ast.parse(textwrap.dedent(inspect.getsource(law.force))).body[0]
    assert isinstance(tree, ast.FunctionDef)  # the registry refuses anything else
    return tree


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _function(file: str, tree: ast.FunctionDef, names: dict[str, Any]) -> Any:
    source = ast.unparse(ast.fix_missing_locations(tree)) + "\n"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    scope: dict[str, Any] = dict(names)
    exec(compile(source, file, "exec"), scope)
    return scope[tree.name]


class _Renamed(ast.NodeTransformer):
    """Reads the deformation at `turn`, and keeps the added law's own variables apart from the first law's."""

    def __init__(self, parameters: set[str], constants: set[str], taken: set[str]) -> None:
        self.parameters = parameters
        self.constants = constants
        self.taken = taken

    def visit_Name(self, node: ast.Name) -> ast.Name:
        if node.id in ("d", "d_max"):
            return ast.Name("turn", node.ctx)
        kept = node.id == "ddot" or node.id in self.parameters or node.id in self.constants or node.id not in self.taken
        return node if kept else ast.Name(f"{node.id}_of_added", node.ctx)
