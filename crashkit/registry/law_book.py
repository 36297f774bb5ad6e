"""The installed spring laws by name, and what is made of several: "crush_plateau + peak", "crush_plateau | maxwell", ..."""

import ast
import builtins
import inspect
import linecache
import textwrap
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

from crashkit.protocols import Laws, ParameterSpec, SpringLaw

HOOK = "added = 0.0"
"""The statement after which a law lets other curves be added to its loading curve, at the deformation that it calls `turn`."""


SLOPE, RATIO = "unloading_stiffness", "slope_ratio"
"""Parameters of a law and of the factor that turns its line of unloading."""


class LawBook(Mapping[str, type[SpringLaw]]):
    """Laws and factors by name; a name may also combine several, where they fit together.

    - "a | b" is a and b side by side, as two joints at the same place would be: F = F_a + F_b;
    - "a & b" is the same of a joint that only pushes, whatever b asks: F = max(0, F_a + F_b);
    - "a % f" is law a of which the share f remembers how far it was compressed and the rest does not: F = f F_a(d, d_max) +
      (1 - f) F_a(d, d);
    - "a / f" is law a that turns to a second, less steep line as it unloads, which factor f gives with its `slope_ratio` r:
      F = max(F_a(d, d_max; k), f F_a(d, d_max; r k / f)), with k the `unloading_stiffness` of a;
    - "a * f" is law a times the factor f alone, where a joint's `factors` multiply all of its force;
    - "a ~ m" is law m, which has a memory, with the force of a for its deformation: what a gives passes through m;
    - "a + b" is law a with b added to its loading curve. Then b takes part in unloading and in the rate factor of a. The first
      law must hold the statement `added = 0.0` after it has set `turn`; what is added must end in its only `return`.

    They bind in the order +, ~, *, /, %, &, |. A parameter that two of them declare alike, such as a clearance, is one and the
    same in all but "a + b"; no other names may be shared, and one of them at most may have a memory. What has branches of its
    own, or runs as plain Python, stands alone.
    """

    def __init__(self, laws: Laws) -> None:
        self._laws = dict(laws)
        self.clashes: Mapping[str, str] = getattr(laws, "clashes", {})

    def __getitem__(self, name: str) -> type[SpringLaw]:
        if name in self._laws:
            return self._laws[name]
        for sign, (fits, combine) in SIGNS.items():
            first, found, second = name.rpartition(sign)
            if found:
                if not fits(self[first], self[second]):
                    raise KeyError(name)
                return combine(self[first], self[second], sign)
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._laws)

    def __len__(self) -> int:
        return len(self._laws)


def are_parallel(first: type[SpringLaw], second: type[SpringLaw]) -> bool:
    """Whether two laws can stand side by side in one joint."""
    return first.unit == second.unit == "N" and _share_no_names(first, second)


def passes(law: type[SpringLaw], through: type[SpringLaw]) -> bool:
    """Whether the force of a law can pass through the memory of another."""
    return are_parallel(law, through) and not law.memory and bool(through.memory)


def parts(law: type[SpringLaw], share: type[SpringLaw]) -> bool:
    """Whether a factor can be the share of a law that remembers its largest deformation."""
    return multiplies(law, share) and not law.memory and not share.memory


def turns(law: type[SpringLaw], line: type[SpringLaw]) -> bool:
    """Whether a factor can turn the line along which a law unloads."""
    return parts(law, line) and _declares(law, SLOPE) and _declares(line, RATIO)


def _declares(law: type[SpringLaw], name: str) -> bool:
    return any(spec.name == name for spec in law.parameters)


def multiplies(law: type[SpringLaw], factor: type[SpringLaw]) -> bool:
    """Whether a factor can multiply a law."""
    return law.unit == "N" and factor.unit == "1" and _share_no_names(law, factor)


def _share_no_names(first: type[SpringLaw], second: type[SpringLaw]) -> bool:
    """Whether names that both have mean the same, one of them at most has a memory, and both are derived."""
    specs = _united(first, second)
    names = [*(spec.name for spec in specs), *(law.memory for law in (first, second) if law.memory)]
    derived = not any(law.opaque or law.branch for law in (first, second))
    return derived and len(set(names)) == len(names) and not (first.memory and second.memory)


def _united(first: type[SpringLaw], second: type[SpringLaw]) -> tuple[ParameterSpec, ...]:
    return (*first.parameters, *(spec for spec in second.parameters if spec not in first.parameters))


def fit_together(first: type[SpringLaw], added: type[SpringLaw]) -> bool:
    """Whether the second law can be added to the loading curve of the first."""
    shared = {spec.name for spec in first.parameters} & {spec.name for spec in added.parameters}
    return can_take(first) and can_be_added(added) and not shared


@cache
def can_take(law: type[SpringLaw]) -> bool:
    """Whether other curves can be added to the law's loading curve."""
    return law.unit == "N" and not law.memory and any(ast.unparse(node) == HOOK for node in _tree(law).body)


@cache
def can_be_added(law: type[SpringLaw]) -> bool:
    """Whether the law can stand in another's loading curve."""
    tree = _tree(law)
    single = sum(isinstance(node, ast.Return) for node in ast.walk(tree)) == 1
    return law.unit == "N" and single and isinstance(tree.body[-1], ast.Return) and not law.memory


@cache
def _joined(first: type[SpringLaw], second: type[SpringLaw], sign: str) -> type[SpringLaw]:
    """One law that calls both: side by side, as law and factor, as law and share, or one with the force of the other."""
    name, specs, memory = f"{first.name}{sign}{second.name}", _united(first, second), first.memory or second.memory
    arguments = ", ".join(["d", "ddot", "d_max", *([memory] if memory else []), *(spec.name for spec in specs)])
    one, other = (", ".join(_arguments(law)) for law in (first, second))
    if sign == " ~ ":
        other = ", ".join([f"first({one})", *_arguments(second)[1:]])
    fresh = ", ".join(["d", "ddot", "d", *_arguments(first)[3:]])
    softer = ", ".join(f"{SLOPE} * {RATIO} / second({other})" if name == SLOPE else name for name in _arguments(first))
    total = {
        " | ": f"first({one}) + second({other})",
        " & ": f"max(0.0, first({one}) + second({other}))",
        " % ": f"second({other}) * first({one}) + (1.0 - second({other})) * first({fresh})",
        " / ": f"max(first({one}), second({other}) * first({softer}))",
        " * ": f"first({one}) * second({other})",
        " ~ ": f"second({other})",
    }
    lines = [f"def force({arguments}):", f"    return {total[sign]}"]
    owner = first if first.memory else second
    if memory:
        lines += [f"def memory_rate({arguments}):", f"    return rate({one if first.memory else other})"]
    names = {"first": first.force, "second": second.force, "rate": getattr(owner, "memory_rate", None)}
    scope = _scope(f"<spring law {name}>", "\n".join(lines) + "\n", names)
    meaning = f"{first.name} {MEANINGS[sign]} {second.name}"
    functions: dict[str, Any] = {part: staticmethod(scope[part]) for part in ("force", "memory_rate") if part in scope}
    return _law(first, second, name, f"{meaning}.", specs, {"memory": memory, **functions})


def _arguments(law: type[SpringLaw]) -> list[str]:
    return ["d", "ddot", "d_max", *([law.memory] if law.memory else []), *(spec.name for spec in law.parameters)]


@cache
def _sum(first: type[SpringLaw], added: type[SpringLaw], sign: str) -> type[SpringLaw]:
    """One law whose loading curve is the sum, written out as source so that the engine can read it like any other."""
    name = f"{first.name}{sign}{added.name}"
    tree, other = _tree(first), _tree(added)
    taken = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    renamed = _Renamed({a.arg for a in other.args.args[3:]}, {*added.force.__globals__, *dir(builtins)}, taken)
    body = [renamed.visit(node) for node in other.body if not _is_docstring(node)]
    total = ast.parse(f"added = added + ({ast.unparse(body.pop().value)})").body
    place = next(i for i, node in enumerate(tree.body) if ast.unparse(node) == HOOK) + 1
    tree.body[place:place] = [*body, *total]
    tree.args.args += other.args.args[3:]
    tree.decorator_list = []
    source = ast.unparse(ast.fix_missing_locations(tree)) + "\n"
    scope = _scope(f"<spring law {name}>", source, {**added.force.__globals__, **first.force.__globals__})
    meaning = f"{first.name} with {added.name} added to its loading curve."
    functions = {"force": staticmethod(scope[tree.name])}
    return _law(first, added, name, meaning, (*first.parameters, *added.parameters), functions)


def _law(
    first: type[SpringLaw],
    second: type[SpringLaw],
    name: str,
    meaning: str,
    parameters: tuple[ParameterSpec, ...],
    others: Mapping[str, Any],
) -> type[SpringLaw]:
    declared = {
        "__doc__": meaning,
        "name": name,
        "parameters": parameters,
        "jumps": first.jumps or second.jumps,
        "passive": first.passive and second.passive,
        "parts": (*(first.parts or (first,)), *(second.parts or (second,))),
    }
    return type("Combined", (SpringLaw,), {**declared, **others})


def _tree(law: type[SpringLaw]) -> ast.FunctionDef:
    tree = ast.parse(textwrap.dedent(inspect.getsource(law.force))).body[0]
    assert isinstance(tree, ast.FunctionDef)  # the registry refuses anything else
    return tree


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _scope(file: str, source: str, names: Mapping[str, Any]) -> dict[str, Any]:
    """The functions of a source that can be read again like that of a file."""
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    scope: dict[str, Any] = dict(names)
    exec(compile(source, file, "exec"), scope)
    return scope


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


SIGNS = {
    " | ": (are_parallel, _joined),
    " & ": (are_parallel, _joined),
    " % ": (parts, _joined),
    " / ": (turns, _joined),
    " * ": (multiplies, _joined),
    " ~ ": (passes, _joined),
    " + ": (fit_together, _sum),
}
"""What a sign asks of two laws, and what it makes of them; the sign that binds least comes first."""
MEANINGS = {" | ": "beside", " & ": "pushing beside", " % ": "in part, by", " / ": "with a", " * ": "times", " ~ ": "through"}
