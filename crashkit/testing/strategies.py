"""Hypothesis strategies for everything that crosses a boundary: datasets of any schema, recordings, motions, models."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from attrs import evolve
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crashkit.data.schema import GroupSchema, Variable
from crashkit.data.schemas import DIMENSIONS, INITIAL, MOTION
from crashkit.model import Body, GivenForce, GivenMotion, InstrumentErrors, Joint, Model, Parameter
from crashkit.model.joint_checks import has_no_direction, specs_of
from crashkit.model.pose import ROTATION, turned
from crashkit.protocols import Laws, ParameterSpec

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
    """Recordings with one to three of these instruments, by their attribute `observer`, with or without `initial`."""
    root = xr.Dataset(attrs={"crashkit_schema": "recording/1", "title": draw(names())})
    groups: dict[str, xr.Dataset] = {"/": root}
    if draw(st.booleans()):
        groups["initial"] = draw(datasets(INITIAL))
    for number, observer in enumerate(draw(st.lists(st.sampled_from(sorted(schemas)), min_size=1, max_size=3))):
        groups[f"{observer}_{number}"] = draw(datasets(schemas[observer])).assign_attrs(observer=observer)
    return xr.DataTree.from_dict(groups)


@st.composite
def parameters(draw: st.DrawFn, spec: ParameterSpec) -> Parameter:
    """Parameters as a plugin declares them, or with bounds of their own, free or fixed."""
    lower, upper = max(spec.lower, -_LARGE), min(spec.upper, _LARGE)
    return draw(_around(draw(st.floats(lower, upper)), spec))


@st.composite
def models(draw: st.DrawFn, laws: Laws, axes: tuple[str, ...] | None = None) -> Model:
    """Models of one to four bodies, joined by these laws and factors, that pass the check of models.

    Arguments:
        laws: installed laws and factors by name.
        axes: of the models; None: any.
    """
    axes = draw(st.sampled_from(_AXES)) if axes is None else axes
    labels = draw(st.lists(names(), min_size=1, max_size=4, unique=True))
    free = draw(st.sampled_from(labels))
    bodies = {name: draw(_bodies(name, len(axes), labels, name == free or draw(st.booleans()))) for name in labels}
    joints = draw(st.lists(names(), max_size=3, unique=True)) if len(labels) > 1 else []
    errors = draw(st.lists(st.tuples(names(), st.just("") | names()), max_size=2, unique=True))
    return Model(
        name=draw(names()),
        axes=axes,
        bodies=tuple(bodies.values()),
        joints=tuple(draw(_joints(name, len(axes), bodies, laws)) for name in joints),
        instruments=tuple(InstrumentErrors(group, sensor, {"gain": draw(parameters(_NUMBER))}) for group, sensor in errors),
        gravity=draw(st.just(()) | _vectors(len(axes))),
    )


_NUMBER = ParameterSpec("number", "", "any number")
_MASS = ParameterSpec("mass", "kg", "mass", lower=1e-3)
_NUMBERS = st.floats(-_LARGE, _LARGE)
_AXES = (("x",), ("y",), ("z",), ("x", "y"), ("x", "z"), ("y", "z"), ("x", "y", "z"))


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
    least = 1e-6 if variable.positive else -_LARGE if variable.allow_negative else 0.0
    values = draw(arrays(float, shape, elements=st.floats(least, _LARGE)))
    if variable.allow_nan and shape and shape[0] > 1:
        values[draw(st.integers(1, shape[0] - 1))] = np.nan
    return values


@st.composite
def _around(draw: st.DrawFn, value: float, spec: ParameterSpec) -> Parameter:
    """A parameter of this value, free or fixed, with the bounds of its spec or others."""
    bounds = draw(
        st.sampled_from([(spec.lower, spec.upper), (value, value), (value - abs(value), value + 1.0), (-math.inf, math.inf)])
    )
    return Parameter(value, *bounds, fixed=draw(st.booleans()))


def _positive(value: float) -> st.SearchStrategy[Parameter]:
    """A mass or moment of inertia of this value; free, it stays above 0."""
    return _around(value, _MASS).filter(lambda entry: entry.fixed or entry.lower >= 0.0)


@st.composite
def _bodies(draw: st.DrawFn, name: str, axes: int, bodies: list[str], free: bool) -> Body:
    position, still = draw(_vectors(axes)), (0.0,) * axes
    orientation = draw(st.just(()) | _orientations(axes))
    if not free and draw(st.booleans()):
        return Body(name, position, still, fixed=True, orientation=orientation)
    if not free:
        motion = draw(_given_motions(axes))
        return Body(name, position, still, orientation=() if motion.orientation else orientation, motion=motion)
    return Body(
        name,
        position,
        velocity=draw(_vectors(axes)),
        mass=draw(_positive(draw(st.floats(1e-3, _LARGE)))),
        carrier=draw(st.sampled_from(["", *(other for other in bodies if other != name)])),
        inertia=draw(_inertias(axes)),
        orientation=orientation,
        angular_velocity=draw(st.just(()) | _vectors(ROTATION[axes])),
        force=draw(st.none() | _given_forces(axes)),
    )


def _vectors(size: int) -> st.SearchStrategy[tuple[float, ...]]:
    return st.tuples(*[_NUMBERS] * size)


def _unit_vectors(size: int) -> st.SearchStrategy[tuple[float, ...]]:
    entries = st.tuples(*[st.floats(-1.0, 1.0)] * size).filter(lambda drawn: math.hypot(*drawn) > 0.1)
    return entries.map(lambda drawn: tuple(value / math.hypot(*drawn) for value in drawn))


def _orientations(axes: int) -> st.SearchStrategy[tuple[float, ...]]:
    return _unit_vectors(4) if axes == 3 else _vectors(ROTATION[axes])


@st.composite
def _inertias(draw: st.DrawFn, axes: int) -> tuple[Parameter, ...]:
    """In space the sums of x^2, y^2 and z^2 over a body, along its axes or others."""
    moments = np.array([draw(st.floats(1e-3, _LARGE)) for _ in range(ROTATION[axes])])
    if axes < 3:
        return tuple(draw(_positive(moment)) for moment in moments.tolist())
    diagonal = moments.sum() - moments
    principal = tuple(draw(_positive(moment)) for moment in diagonal.tolist())
    turn = draw(_unit_vectors(4))
    columns = np.array([turned(turn, column) for column in np.eye(3)])
    matrix = columns.T * diagonal @ columns
    if draw(st.booleans()):
        return principal
    products = [draw(_around(float(matrix[pair]), _NUMBER)) for pair in ((0, 1), (0, 2), (1, 2))]
    return (*(draw(_positive(moment)) for moment in np.diagonal(matrix).tolist()), *products)


@st.composite
def _given_motions(draw: st.DrawFn, axes: int) -> GivenMotion:
    time = tuple(draw(times().filter(lambda drawn: drawn.size > 1)).tolist())
    turns = axes > 1 and draw(st.booleans())
    return GivenMotion(
        time,
        position=tuple(draw(_vectors(axes)) for _ in time),
        orientation=tuple(draw(_orientations(axes)) for _ in time) if turns else (),
    )


@st.composite
def _given_forces(draw: st.DrawFn, axes: int) -> GivenForce:
    time = tuple(draw(times().filter(lambda drawn: drawn.size > 1)).tolist())
    turns = axes > 1 and draw(st.booleans())
    return GivenForce(
        time,
        force=tuple(draw(_vectors(axes)) for _ in time),
        moment=tuple(draw(_vectors(ROTATION[axes])) for _ in time) if turns else (),
    )


@st.composite
def _joints(draw: st.DrawFn, name: str, axes: int, bodies: Mapping[str, Body], laws: Laws) -> Joint:
    first, second = draw(st.permutations(list(bodies)))[:2]
    law = draw(st.sampled_from(sorted(name for name, law in laws.items() if law.unit == "N")))
    factors = [name for name in sorted(laws) if laws[name].unit == "1" and draw(st.booleans())]
    length = draw(st.integers(1, 4))
    specs = specs_of(law, factors, laws)
    values: dict[str, Any] = {
        name: draw(_lists(spec, length) if spec.vector else parameters(spec)) for name, spec in specs.items()
    }
    joint = Joint(
        name=name,
        bodies=(first, second),
        law=law,
        parameters=values,
        factors=tuple(factors),
        points=draw(st.none() | st.tuples(_vectors(axes), _vectors(axes))),
        free_length=draw(st.none() | parameters(_NUMBER)),
        normal=draw(st.none() | _unit_vectors(axes)) if axes > 1 else None,
    )
    return evolve(joint, normal=draw(_unit_vectors(axes))) if has_no_direction(joint, bodies, axes) else joint


def _lists(spec: ParameterSpec, length: int) -> st.SearchStrategy[tuple[Parameter, ...]]:
    entries = st.lists(parameters(spec), min_size=length, max_size=length, unique_by=lambda entry: entry.value)
    return entries.map(lambda drawn: tuple(sorted(drawn, key=lambda entry: entry.value)))
