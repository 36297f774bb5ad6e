"""Spring laws as Markdown, from what they declare: so that the documentation cannot differ from what is computed."""

import inspect
import math
from collections.abc import Iterable

from crashkit.protocols import ParameterSpec, SpringLaw

HEAD = ("parameter", "unit", "meaning", "bounds", "if omitted")


def describe_laws(laws: Iterable[type[SpringLaw]]) -> str:
    """A reference of laws, then of factors, each by its name."""
    known = sorted(laws, key=lambda law: law.name)
    parts = [("Laws", "N"), ("Factors", "1")]
    return "\n".join(f"## {title}\n\n" + "\n".join(map(describe_law, _of_unit(known, unit))) for title, unit in parts)


def describe_law(law: type[SpringLaw]) -> str:
    """A law as a section: what its docstring says, what it declares, and a table of its parameters."""
    rows = [HEAD, ("---",) * len(HEAD), *map(_row, law.parameters)]
    table = "".join(f"| {' | '.join(row)} |\n" for row in rows)
    return f"### {law.name}\n\n{inspect.getdoc(law)}\n\n{_notes(law)}{table}"


def _of_unit(laws: Iterable[type[SpringLaw]], unit: str) -> list[type[SpringLaw]]:
    return [law for law in laws if law.unit == unit]


def _notes(law: type[SpringLaw]) -> str:
    notes = [
        *([f"has the memory `{law.memory}`"] if law.memory else []),
        *(["jumps"] if law.jumps else []),
        *(["may give out more energy than it took in"] if law.unit == "N" and not law.passive else []),
        *(["runs as plain Python, without sensitivities"] if law.opaque else []),
    ]
    return f"It {'; '.join(notes)}.\n\n" if notes else ""


def _row(spec: ParameterSpec) -> tuple[str, ...]:
    meaning = spec.meaning.replace("|", "\\|")
    name = f"`{spec.name}`" + (", a list" if spec.vector else "")
    omitted = "must be given" if spec.default is None else f"{spec.default:g}"
    return name, spec.unit, meaning, _bounds(spec), omitted


def _bounds(spec: ParameterSpec) -> str:
    if math.isinf(spec.upper):
        bounds = "any" if math.isinf(spec.lower) else f"{spec.lower:g} or more"
    else:
        bounds = f"{spec.upper:g} or less" if math.isinf(spec.lower) else f"{spec.lower:g} to {spec.upper:g}"
    return bounds if spec.free else f"{bounds}; fixed unless freed"
