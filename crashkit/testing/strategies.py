"""Hypothesis strategies for everything that crosses a boundary: datasets of any schema, recordings, motions, models."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import DIMENSIONS, INITIAL, MOTION
from crashkit.model import Body, InstrumentErrors, Joint, Model, Parameter
from crashkit.model.checks import specs_of
from crashkit.protocols import ParameterSpec, SpringLaw

_KNOWN = {dimension.name: dimension for dimension in DIMENSIONS}
_LARGE = 1e6


def names() -> st.SearchStrategy[str]:
    """Names of bodies, joints and sensors: letters of any script, digits, spaces, quotes."""
    alphabet = st.characters(categories=("L", "Nd"), include_characters=" _-.\"'")
    return st.text(alphabet, min_size=1, max_size=12)


def times(max_size: int = 6) -> st.SearchStrategy[np.ndarray]:
    """Time stamps in s: strictly increasing, not uniform."""
    steps = st.lists(st.floats(1e-4, 1e-2), min_size=1, max_size=max_size)
    return st.tuples(st.floats(-0.1, 0.1), steps).map(lambda drawn: drawn[0] + np.cumsum(drawn[1]))


@st.composite
def datasets(draw: st.DrawFn, schema: GroupSchema) -> xr.Dataset:
    """Datasets that keep a schema, with some of its optional variables, and NaN where it may be."""
    optional = [variable for variable in schema.variables if not variable.required]
    needed = 0 if len(optional) < len(schema.variables) else 1
    chosen = draw(st.lists(st.sampled_from(optional), min_size=needed, unique=True)) if optional else []
    present = [variable for variable in schema.variables if variable.required or variable in chosen]
    dims = {variable.name: tuple(draw(st.sampled_from(dim.split("|"))) for dim in variable.dims) for variable in present}
    labels = {dim: draw(_labels(dim)) for dim in dict.fromkeys(dim for used in dims.values() for dim in used)}
    variables = {
        variable.name: (dims[variable.name], draw(_values(variable, tuple(len(labels[dim]) for dim in dims[variable.name]))))
        for variable in present
    }
    units = {variable.name: {"units": variable.units} for variable in present if variable.units is not None}
    attributes = {
        entry.name: draw(st.sampled_from(entry.values) if entry.values else names())
        for entry in schema.attributes
        if entry.required or draw(st.booleans())
    }
    return xr.Dataset(
        {name: (dim, values, units.get(name)) for name, (dim, values) in variables.items()},
        {dim: (dim, values, {"units": "s"} if dim == "time" else None) for dim, values in labels.items()},
        attributes,
    )


def motions() -> st.SearchStrategy[xr.Dataset]:
    """Motions of one to three bodies."""
    return datasets(MOTION)


@st.composite
def recordings(draw: st.DrawFn, schemas: Mapping[str, GroupSchema]) -> xr.DataTree:
    """Recordings with groups of these instruments, by the value of their attribute `observer`, with or without `initial`."""
    root = xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": draw(names())})
    groups: dict[str, xr.Dataset] = {"/": root}
    if draw(st.booleans()):
        groups["initial"] = draw(datasets(INITIAL))
    for number, observer in enumerate(draw(st.lists(st.sampled_from(sorted(schemas)), max_size=3))):
        groups[f"{observer}_{number}"] = draw(datasets(schemas[observer])).assign_attrs(observer=observer)
    return xr.DataTree.from_dict(groups)


@st.composite
def parameters(draw: st.DrawFn, spec: ParameterSpec) -> Parameter:
    """Parameters as a plugin declares them, or with bounds of their own, free or fixed."""
    lower, upper = max(spec.lower, -_LARGE), min(spec.upper, _LARGE)
    value = draw(st.floats(lower, upper))
    bounds = draw(
        st.sampled_from([(spec.lower, spec.upper), (value, value), (value - abs(value), value + 1.0), (-math.inf, math.inf)])
    )
    return Parameter(value, *bounds, fixed=draw(st.booleans()))


@st.composite
def models(draw: st.DrawFn, laws: Mapping[str, type[SpringLaw]]) -> Model:
    """Models in one axis of one to three free bodies and perhaps an obstacle, joined by these laws and factors."""
    labels = draw(st.lists(names(), min_size=1, max_size=4, unique=True))
    fixed = [len(labels) > 1 and draw(st.booleans()), *([False] * (len(labels) - 1))]
    bodies = tuple(draw(_bodies(name, held, labels)) for name, held in zip(labels, fixed, strict=True))
    joints = draw(st.lists(names(), max_size=3, unique=True)) if len(labels) > 1 else []
    errors = draw(st.lists(st.tuples(names(), st.just("") | names()), max_size=2, unique=True))
    return Model(
        name=draw(names()),
        axes=(draw(st.sampled_from("xyz")),),
        bodies=bodies,
        joints=tuple(draw(_joints(name, labels, laws)) for name in joints),
        instruments=tuple(InstrumentErrors(group, sensor, {"gain": draw(parameters(_NUMBER))}) for group, sensor in errors),
    )


_NUMBER = ParameterSpec("number", "", "any number")
_MASS = ParameterSpec("mass", "kg", "mass", lower=1e-3)
_NUMBERS = st.floats(-_LARGE, _LARGE)


def _labels(dim: str) -> st.SearchStrategy[np.ndarray]:
    if dim == "time":
        return times()
    known = _KNOWN.get(dim)
    labels = st.sampled_from(known.values) if known is not None and known.values else names()
    return st.lists(labels, min_size=1, max_size=3, unique=True).map(lambda drawn: np.array(drawn, dtype=str))


@st.composite
def _values(draw: st.DrawFn, variable: Variable, shape: tuple[int, ...]) -> np.ndarray:
    if variable.kind == "text":
        return draw(arrays("<U12", shape, elements=names()))
    if variable.kind == "flag":
        return draw(arrays(np.int8, shape, elements=st.integers(0, 1)))
    values = draw(arrays(float, shape, elements=st.floats(1e-6, _LARGE) if variable.positive else _NUMBERS))
    if variable.allow_nan and shape and shape[0] > 1:
        values[draw(st.integers(1, shape[0] - 1))] = np.nan
    return values


@st.composite
def _bodies(draw: st.DrawFn, name: str, fixed: bool, bodies: list[str]) -> Body:
    position = (draw(_NUMBERS),)
    if fixed:
        return Body(name, position, (0.0,), fixed=True)
    mass = draw(parameters(_MASS).filter(lambda mass: mass.fixed or mass.lower >= 0.0))
    carrier = draw(st.sampled_from(["", *(other for other in bodies if other != name)]))
    return Body(name, position, (draw(_NUMBERS),), mass, carrier=carrier)


@st.composite
def _joints(draw: st.DrawFn, name: str, bodies: list[str], laws: Mapping[str, type[SpringLaw]]) -> Joint:
    first, second = draw(st.permutations(bodies))[:2]
    law = draw(st.sampled_from(sorted(name for name, law in laws.items() if law.unit == "N")))
    factors = [name for name in sorted(laws) if laws[name].unit == "1" and draw(st.booleans())]
    length = draw(st.integers(1, 4))
    specs = specs_of(law, factors, laws)
    values: dict[str, Any] = {
        name: draw(_vectors(spec, length) if spec.vector else parameters(spec)) for name, spec in specs.items()
    }
    return Joint(
        name=name,
        bodies=(first, second),
        law=law,
        parameters=values,
        factors=tuple(factors),
        points=draw(st.none() | st.tuples(st.tuples(_NUMBERS), st.tuples(_NUMBERS))),
        free_length=draw(st.none() | parameters(_NUMBER)),
    )


def _vectors(spec: ParameterSpec, length: int) -> st.SearchStrategy[tuple[Parameter, ...]]:
    entries = st.lists(parameters(spec), min_size=length, max_size=length, unique_by=lambda entry: entry.value)
    return entries.map(lambda drawn: tuple(sorted(drawn, key=lambda entry: entry.value)))
