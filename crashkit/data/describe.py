"""Schemas as tables, so that the documentation cannot differ from what is checked."""

from collections.abc import Sequence

from crashkit.data.schema import Attribute, GroupSchema, Variable
from crashkit.data.schemas import DIMENSIONS
from crashkit.data.validate import names


def describe(schema: GroupSchema) -> str:
    """A schema as Markdown: a table of its variables, and one of its attributes where it has any."""
    tables = []
    if schema.variables:
        rows = [_variable_row(variable) for variable in schema.variables]
        tables.append(_table(("variable", "dims", "units", "meaning"), rows))
    if schema.attributes:
        tables.append(_table(("attribute", "values", "meaning"), [_attribute_row(entry) for entry in schema.attributes]))
    return "\n".join(tables)


def describe_dimensions() -> str:
    """The dimensions that every group shares, as a Markdown table."""
    rows = [
        (f"`{dim.name}`", dim.meaning, ", ".join(dim.values) or "any", "required" if dim.labelled else "optional")
        for dim in DIMENSIONS
    ]
    return _table(("dimension", "meaning", "labels", "coordinate"), rows)


def _variable_row(variable: Variable) -> tuple[str, ...]:
    dims = ", ".join(dim.replace("|", " or ") for dim in variable.dims)
    notes = [
        variable.meaning,
        *(["optional"] if not variable.required else []),
        *([_missing(variable)] if variable.allow_nan else []),
        *(["0 or more"] if not variable.allow_negative else []),
        *(["above 0"] if variable.positive else []),
        *(["0 or 1"] if variable.kind == "flag" else []),
    ]
    return f"`{variable.name}`", dims, variable.units or variable.kind, "; ".join(notes)


def _missing(variable: Variable) -> str:
    return f"NaN where missing{', even throughout' if variable.allow_silent else ''}"


def _attribute_row(attribute: Attribute) -> tuple[str, ...]:
    optional = "" if attribute.required else "; optional"
    return f"`{attribute.name}`", names(attribute.values) or "any", attribute.meaning + optional


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)
