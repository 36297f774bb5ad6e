"""Models as Datasets: the same content as TOML, for programs and netCDF."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from crashkit.data.schema import Attribute, GroupSchema, Variable
from crashkit.data.validate import check
from crashkit.errors import ContractError, Fault
from crashkit.model.body import Body
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.parameter import Parameter

MODEL = GroupSchema(
    "model",
    (
        Variable("body_position", ("body", "axis"), "m", "centre of mass at t = 0"),
        Variable("body_velocity", ("body", "axis"), "m s-1", "at t = 0"),
        Variable("body_fixed", ("body",), None, "whether it is held in place", kind="flag"),
        Variable("body_carrier", ("body",), None, "the body that it moves with until t = 0; empty for none", kind="text"),
        Variable("joint_bodies", ("joint", "end"), None, "names of the two bodies", kind="text"),
        Variable("joint_points", ("joint", "end", "axis"), "m", "attachment in each body's frame", allow_nan=True),
        Variable("joint_law", ("joint",), None, "name of the spring law", kind="text"),
        Variable("factor_joint", ("factor",), None, "the joint whose law it multiplies", kind="text"),
        Variable("factor_law", ("factor",), None, "name of the factor", kind="text"),
        Variable("instrument_group", ("instrument",), None, "group of the recordings", kind="text"),
        Variable("instrument_sensor", ("instrument",), None, "sensor or marker; empty for the whole instrument", kind="text"),
        Variable("value", ("parameter",), None, "in the unit that its plugin declares"),
        Variable("lower", ("parameter",), None, "lower bound", allow_infinite=True),
        Variable("upper", ("parameter",), None, "upper bound", allow_infinite=True),
        Variable("fixed", ("parameter",), None, "whether it is held in an identification", kind="flag"),
        Variable("owner_kind", ("parameter",), None, "body, joint or instrument", kind="text"),
        Variable("owner_index", ("parameter",), None, "which one, from 0"),
        Variable("parameter_name", ("parameter",), None, "as its owner calls it", kind="text"),
        Variable("parameter_index", ("parameter",), None, "place in a list, from 0; -1 for a single number"),
    ),
    (Attribute("crashkit_schema", "the version of the contract", ("crashkit-model/1",)), Attribute("name", "of the model")),
)

_UNITS = {variable.name: {"units": variable.units} for variable in MODEL.variables if variable.units is not None}


def model_to_dataset(model: Model) -> xr.Dataset:
    """A model as a Dataset with the variables of MODEL."""
    rows = list(_rows(model))
    parameters = [parameter for *_, parameter in rows]
    factors = [(joint.name, factor) for joint in model.joints for factor in joint.factors]
    columns = {
        "body_position": _numbers([body.position for body in model.bodies], len(model.axes)),
        "body_velocity": _numbers([body.velocity for body in model.bodies], len(model.axes)),
        "body_fixed": np.array([body.fixed for body in model.bodies], dtype=np.int8),
        "body_carrier": _text([body.carrier for body in model.bodies]),
        "joint_bodies": _text([joint.bodies for joint in model.joints]).reshape(-1, 2),
        "joint_points": _numbers([_points(joint, len(model.axes)) for joint in model.joints], 2, len(model.axes)),
        "joint_law": _text([joint.law for joint in model.joints]),
        "factor_joint": _text([joint for joint, _ in factors]),
        "factor_law": _text([factor for _, factor in factors]),
        "instrument_group": _text([errors.instrument for errors in model.instruments]),
        "instrument_sensor": _text([errors.sensor for errors in model.instruments]),
        "value": _numbers([parameter.value for parameter in parameters]),
        "lower": _numbers([parameter.lower for parameter in parameters]),
        "upper": _numbers([parameter.upper for parameter in parameters]),
        "fixed": np.array([parameter.fixed for parameter in parameters], dtype=np.int8),
        "owner_kind": _text([kind for kind, *_ in rows]),
        "owner_index": np.array([owner for _, owner, *_ in rows], dtype=np.int64),
        "parameter_name": _text([name for _, _, name, *_ in rows]),
        "parameter_index": np.array([index for *_, index, _ in rows], dtype=np.int64),
    }
    dims = {variable.name: variable.dims for variable in MODEL.variables}
    coords = {
        "axis": _text(model.axes),
        "body": _text([body.name for body in model.bodies]),
        "joint": _text([joint.name for joint in model.joints]),
        "parameter": _text(list(model.parameters())),
    }
    variables = {name: xr.Variable(dims[name], values, _UNITS.get(name)) for name, values in columns.items()}
    return xr.Dataset(variables, coords, {"crashkit_schema": "crashkit-model/1", "name": model.name})


def model_from_dataset(dataset: xr.Dataset, source: str = "dataset") -> Model:
    """The model that a Dataset with the variables of MODEL holds.

    Raises:
        ContractError: with every fault, if the Dataset breaks that schema; whether the model can be simulated is
            `check_model`'s to say.
    """
    check(dataset, MODEL, source)
    _check_owners(dataset, source)
    columns: dict[str, list[Any]] = {str(name): variable.values.tolist() for name, variable in dataset.variables.items()}
    return Model(
        name=str(dataset.attrs["name"]),
        axes=tuple(columns["axis"]),
        bodies=tuple(_body(columns, index) for index in range(dataset.sizes["body"])),
        joints=tuple(_joint(columns, index) for index in range(dataset.sizes["joint"])),
        instruments=tuple(
            InstrumentErrors(group, sensor, _owned(columns, "instrument", index))
            for index, (group, sensor) in enumerate(
                zip(columns["instrument_group"], columns["instrument_sensor"], strict=True)
            )
        ),
    )


def _rows(model: Model) -> Iterator[tuple[str, int, str, int, Parameter]]:
    """Kind and index of the owner, name, place in a list, parameter: in the order of `Model.parameters`."""
    for owner, body in enumerate(model.bodies):
        if body.mass is not None:
            yield "body", owner, "mass", -1, body.mass
    for owner, joint in enumerate(model.joints):
        if joint.free_length is not None:
            yield "joint", owner, "free_length", -1, joint.free_length
        for name, value in joint.parameters.items():
            if isinstance(value, Parameter):
                yield "joint", owner, name, -1, value
            else:
                yield from (("joint", owner, name, index, entry) for index, entry in enumerate(value))
    for owner, errors in enumerate(model.instruments):
        yield from (("instrument", owner, name, -1, parameter) for name, parameter in errors.parameters.items())


def _points(joint: Joint, axes: int) -> object:
    return joint.points if joint.points is not None else [[np.nan] * axes] * 2


def _numbers(values: list[Any], *shape: int) -> np.ndarray:
    return np.array(values, dtype=float).reshape(-1, *shape)


def _text(values: Any) -> np.ndarray:
    return np.array(values, dtype=str)


def _check_owners(dataset: xr.Dataset, source: str) -> None:
    sizes = {kind: dataset.sizes[kind] for kind in ("body", "joint", "instrument")}
    owners = zip(
        dataset.variables["owner_kind"].values.tolist(), dataset.variables["owner_index"].values.tolist(), strict=True
    )
    faults = [
        Fault("model/owner_index", "a body, joint or instrument of the model", f"{kind} {index}")
        for kind, index in owners
        if index not in range(sizes.get(kind, 0))
    ]
    if faults:
        raise ContractError(source, faults)


def _body(columns: dict[str, list[Any]], index: int) -> Body:
    return Body(
        name=columns["body"][index],
        position=tuple(columns["body_position"][index]),
        velocity=tuple(columns["body_velocity"][index]),
        mass=_owned(columns, "body", index).get("mass"),
        fixed=bool(columns["body_fixed"][index]),
        carrier=columns["body_carrier"][index],
    )


def _joint(columns: dict[str, list[Any]], index: int) -> Joint:
    name, points = columns["joint"][index], columns["joint_points"][index]
    parameters = _owned(columns, "joint", index)
    factors = zip(columns["factor_joint"], columns["factor_law"], strict=True)
    first, second = columns["joint_bodies"][index]
    return Joint(
        name=name,
        bodies=(first, second),
        law=columns["joint_law"][index],
        free_length=parameters.pop("free_length", None),
        parameters=parameters,
        factors=tuple(factor for joint, factor in factors if joint == name),
        points=None if np.isnan(points).all() else (tuple(points[0]), tuple(points[1])),
    )


def _owned(columns: dict[str, list[Any]], kind: str, owner: int) -> dict[str, Any]:
    """The parameters of one body, joint or instrument; a list becomes a tuple."""
    names = ("owner_kind", "owner_index", "parameter_name", "parameter_index", "value", "lower", "upper", "fixed")
    found: dict[str, Any] = {}
    for row_kind, row_owner, name, index, value, lower, upper, fixed in zip(*(columns[key] for key in names), strict=True):
        if (row_kind, row_owner) == (kind, owner):
            parameter = Parameter(value, lower, upper, bool(fixed))
            found[name] = parameter if index < 0 else (*found.get(name, ()), parameter)
    return found
