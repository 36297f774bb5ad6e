"""Validation at the edges: every fault of a Dataset against its schema, in one error."""

from collections.abc import Iterable, Iterator

import numpy as np
import xarray as xr

from crashkit.data.schema import Attribute, Dimension, GroupSchema, Variable
from crashkit.data.schemas import DIMENSIONS
from crashkit.errors import ContractError, Fault

_KNOWN = {dimension.name: dimension for dimension in DIMENSIONS}
_WITHIN_CHANNEL = ("time", "view")


def check(dataset: xr.Dataset, schema: GroupSchema, source: str, group: str | None = None) -> None:
    """Refuse a Dataset that breaks its schema.

    Arguments:
        dataset: to be checked.
        schema: what it should hold.
        source: the file or caller that the error names.
        group: the group that the error names; None: the schema's name.

    Raises:
        ContractError: with every fault.
    """
    faults = faults_of(dataset, schema, group)
    if faults:
        raise ContractError(source, faults)


def faults_of(dataset: xr.Dataset, schema: GroupSchema, group: str | None = None) -> list[Fault]:
    """Every fault of a Dataset; places are written group/variable. Unknown extra variables and attributes are no fault."""
    return list(_group_faults(dataset, schema, schema.name if group is None else group))


def _group_faults(dataset: xr.Dataset, schema: GroupSchema, group: str) -> Iterator[Fault]:
    present = [variable for variable in schema.variables if variable.name in dataset.variables]
    for attribute in schema.attributes:
        yield from _attribute_faults(dataset, attribute, group)
    yield from _missing_variables(schema, present, group)
    for name in dict.fromkeys(dim for variable in present for dim in dataset.variables[variable.name].dims):
        if name in _KNOWN:
            yield from _dimension_faults(dataset, _KNOWN[name], f"{group}/{name}")
    for variable in present:
        yield from _variable_faults(dataset, variable, f"{group}/{variable.name}")


def _attribute_faults(dataset: xr.Dataset, attribute: Attribute, group: str) -> Iterator[Fault]:
    allowed = f"one of {names(attribute.values)}" if attribute.values else ""
    expected = f"attribute {attribute.name} {allowed}".rstrip()
    if attribute.name not in dataset.attrs:
        if attribute.required:
            yield Fault(group, expected, "none")
        return
    value = plain_value(dataset.attrs[attribute.name])
    if attribute.values and value not in attribute.values:
        yield Fault(group, expected, shown(value))


def _missing_variables(schema: GroupSchema, present: list[Variable], group: str) -> Iterator[Fault]:
    for variable in schema.variables:
        if variable.required and variable not in present:
            yield Fault(f"{group}/{variable.name}", f"a variable with dims {_dims(variable.dims)}", "none")
    if schema.variables and not present and not any(variable.required for variable in schema.variables):
        yield Fault(group, f"at least one of {', '.join(variable.name for variable in schema.variables)}", "none")


def _dimension_faults(dataset: xr.Dataset, dimension: Dimension, place: str) -> Iterator[Fault]:
    if dataset.sizes[dimension.name] < dimension.least:
        yield Fault(place, "at least one value", "none")
    elif dimension.name not in dataset.variables:
        if dimension.labelled:
            yield Fault(place, f"a coordinate ({dimension.meaning})", "none")
    elif dimension.name == "time":
        yield from _time_faults(dataset.variables["time"], place)
    else:
        yield from _label_faults(dataset.variables[dimension.name].values, dimension, place)


def _time_faults(time: xr.Variable, place: str) -> Iterator[Fault]:
    if not _is_kind(time.values, "number"):
        yield Fault(place, "numbers", _kind_name(time.values))
        return
    yield from _units_faults(time, "s", place)
    values = np.asarray(time.values, dtype=float)
    for name, wrong in (("NaN", np.isnan(values)), ("infinite", np.isinf(values))):
        if wrong.any():
            yield Fault(place, "finite values", f"{name} at index {np.argmax(wrong)} ({wrong.sum()} in all)")
    backward = np.diff(values) <= 0
    if backward.any():
        index = int(np.argmax(backward)) + 1
        yield Fault(place, "strictly increasing values", f"{values[index]} after {values[index - 1]} at index {index}")


def _label_faults(labels: np.ndarray, dimension: Dimension, place: str) -> Iterator[Fault]:
    if not _is_kind(labels, "text"):
        yield Fault(place, "text labels", _kind_name(labels))
        return
    found = labels.astype(str).tolist()
    if "" in found:
        yield Fault(place, "labels that are not empty", f'"" at index {found.index("")}')
    repeated = [label for label in dict.fromkeys(found) if found.count(label) > 1]
    if repeated:
        yield Fault(place, "labels without repeats", f"{names(repeated)} more than once")
    unknown = [label for label in found if label not in dimension.values]
    if dimension.values and unknown:
        yield Fault(place, f"labels out of {names(dimension.values)}", names(unknown))


def _variable_faults(dataset: xr.Dataset, variable: Variable, place: str) -> Iterator[Fault]:
    found = dataset.variables[variable.name]
    dims_fit = _dims_fit(tuple(map(str, found.dims)), variable.dims)
    kind_fits = _is_kind(found.values, variable.kind)
    if not dims_fit:
        yield Fault(place, f"dims {_dims(variable.dims)}", _dims(found.dims))
    if not kind_fits:
        yield Fault(place, _KIND_NAMES[variable.kind], _kind_name(found.values))
    if variable.units is not None:
        yield from _units_faults(found, variable.units, place)
    if dims_fit and kind_fits and variable.kind != "text":
        yield from _value_faults(dataset, variable, np.asarray(found.values, dtype=float), place)


def _units_faults(variable: xr.Variable, units: str, place: str) -> Iterator[Fault]:
    found = variable.attrs.get("units")
    if found != units:
        yield Fault(place, f'units "{units}"', "none" if found is None else shown(plain_value(found)))


def _value_faults(dataset: xr.Dataset, variable: Variable, values: np.ndarray, place: str) -> Iterator[Fault]:
    dims = tuple(map(str, dataset.variables[variable.name].dims))
    missing = np.isnan(values)
    empty = _empty_channels(missing, dims)
    for index in np.argwhere(empty & (empty.all() or not variable.allow_silent)):
        yield Fault(place, "a value in every channel", f"only NaN{_at(dataset, dims, index, _WITHIN_CHANNEL)}")
    rules = [
        ("no NaN", "NaN", missing & ~empty & (not variable.allow_nan)),
        ("finite values", "infinite", np.isinf(values) & (not variable.allow_infinite)),
        ("values of at least 0", "below 0", (values < 0) & (not variable.allow_negative)),
        ("values above 0", "not above 0", (values <= 0) & variable.positive),
        ("0 or 1", "neither", (values != 0) & (values != 1) & ~missing & (variable.kind == "flag")),
    ]
    for expected, name, wrong in rules:
        if wrong.any():
            first = _at(dataset, dims, np.argwhere(wrong)[0])
            yield Fault(place, expected, f"{wrong.sum()} of {wrong.size} values {name}" + (first and f", the first{first}"))


def _empty_channels(missing: np.ndarray, dims: tuple[str, ...]) -> np.ndarray:
    """Which channels have no value at any time: the shape of `missing`, with length 1 along time."""
    if "time" not in dims or missing.size == 0:
        return np.zeros((1,) * missing.ndim, dtype=bool)
    within = tuple(position for position, dim in enumerate(dims) if dim in _WITHIN_CHANNEL)
    return np.asarray(missing.all(axis=within, keepdims=True))


def _at(dataset: xr.Dataset, dims: tuple[str, ...], index: np.ndarray, without: tuple[str, ...] = ()) -> str:
    """Where in a Dataset: ` at time 0.012 (index 12), marker "engine", axis "x"`; empty for a scalar."""
    labels = [_label(dataset, dim, at) for dim, at in zip(dims, index.tolist(), strict=True) if dim not in without]
    return f" at {', '.join(labels)}" if labels else ""


def _label(dataset: xr.Dataset, dim: str, position: int) -> str:
    if dim not in dataset.variables:
        return f"{dim} {position}"
    value = shown(plain_value(dataset.variables[dim].values[position]))
    return f"{dim} {value} (index {position})" if dim == "time" else f"{dim} {value}"


def _dims_fit(found: tuple[str, ...], expected: tuple[str, ...]) -> bool:
    return len(found) == len(expected) and all(dim in choice.split("|") for dim, choice in zip(found, expected, strict=True))


def _dims(dims: tuple[object, ...]) -> str:
    return f"({', '.join(str(dim).replace('|', ' or ') for dim in dims)})"


_KIND_NAMES = {"number": "numbers", "text": "text", "flag": "flags (0 or 1)"}


def _is_kind(values: np.ndarray, kind: str) -> bool:
    if kind == "text":
        return is_text(values)
    return values.dtype.kind in {"number": "iuf", "flag": "biuf"}[kind]


def is_text(values: np.ndarray) -> bool:
    """Whether an array holds text, in any of the ways in which numpy and netCDF store it."""
    return values.dtype.kind in "UST" or (values.dtype.kind == "O" and all(isinstance(value, str) for value in values.flat))


def _kind_name(values: np.ndarray) -> str:
    return "text" if is_text(values) else f"values of type {values.dtype}"


def plain_value(value: object) -> object:
    """A numpy scalar or array as Python's own number, text or list."""
    return value.tolist() if isinstance(value, np.generic | np.ndarray) else value


def shown(value: object) -> str:
    """A value as messages show it: text in double quotes, lists in brackets, numbers and truth values as files have them."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f"[{names(value)}]"
    if isinstance(value, dict):
        return "a table"
    return f'"{value}"' if isinstance(value, str) else str(value)


def names(values: Iterable[object]) -> str:
    """Several values as messages show them, separated by commas."""
    return ", ".join(shown(value) for value in values)
