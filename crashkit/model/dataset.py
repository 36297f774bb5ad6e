"""Models as Datasets: the same content as TOML, for programs and netCDF."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from crashkit.data.validate import check
from crashkit.errors import ContractError, Fault
from crashkit.model.body import Body
from crashkit.model.dataset_given import forces_to_columns, given_force, given_motion, motions_to_columns
from crashkit.model.dataset_schema import MODEL
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.parameter import Parameter
from crashkit.model.pose import ORIENTATION, ROTATION

__all__ = ["MODEL", "model_from_dataset", "model_to_dataset"]

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
        **_in_some(model),
        **motions_to_columns(model),
        **forces_to_columns(model),
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
        gravity=tuple(columns.get("gravity", ())),
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
        yield from _entries("body", owner, "inertia", body.inertia[0] if len(body.inertia) == 1 else body.inertia)
    for owner, joint in enumerate(model.joints):
        if joint.free_length is not None:
            yield "joint", owner, "free_length", -1, joint.free_length
        for name, value in joint.parameters.items():
            yield from _entries("joint", owner, name, value)
    for owner, errors in enumerate(model.instruments):
        yield from (("instrument", owner, name, -1, parameter) for name, parameter in errors.parameters.items())


def _entries(
    kind: str, owner: int, name: str, value: Parameter | tuple[Parameter, ...]
) -> Iterator[tuple[str, int, str, int, Parameter]]:
    if isinstance(value, Parameter):
        yield kind, owner, name, -1, value
    else:
        yield from ((kind, owner, name, index, entry) for index, entry in enumerate(value))


def _in_some(model: Model) -> dict[str, np.ndarray]:
    """What most models have nothing of, such as gravity and supports: only what some part of the model has."""
    axes, bodies, joints = len(model.axes), model.bodies, model.joints
    columns = {
        "body_orientation": _optional([body.orientation for body in bodies], ORIENTATION[axes]),
        "body_angular_velocity": _optional([body.angular_velocity for body in bodies], ROTATION[axes]),
        "joint_normal": _optional([joint.normal or () for joint in joints], axes),
    }
    gravity = {"gravity": np.array(model.gravity)} if model.gravity else {}
    supports = [joint.support for joint in joints]
    support = {"joint_support": np.array(supports, dtype=np.int8)} if any(supports) else {}
    linked = [joint.acts_on or ("", "") for joint in joints]
    linkage = {"joint_acts_on": _text(linked)} if any(joint.acts_on for joint in joints) else {}
    driven = {"joint_driver": _text([joint.driver for joint in joints])} if any(joint.driver for joint in joints) else {}
    return (
        gravity | support | linkage | driven | {name: column for name, column in columns.items() if not np.isnan(column).all()}
    )


def _optional(rows: list[tuple[float, ...]], size: int) -> np.ndarray:
    return np.array([row or (np.nan,) * size for row in rows], dtype=float).reshape(len(rows), size)


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
    name, parameters = columns["body"][index], _owned(columns, "body", index)
    inertia = parameters.get("inertia", ())
    return Body(
        name=name,
        position=tuple(columns["body_position"][index]),
        velocity=tuple(columns["body_velocity"][index]),
        mass=parameters.get("mass"),
        fixed=bool(columns["body_fixed"][index]),
        carrier=columns["body_carrier"][index],
        inertia=(inertia,) if isinstance(inertia, Parameter) else inertia,
        orientation=_row(columns, "body_orientation", index),
        angular_velocity=_row(columns, "body_angular_velocity", index),
        motion=given_motion(columns, name),
        force=given_force(columns, name),
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
        normal=_row(columns, "joint_normal", index) or None,
        support=bool(columns["joint_support"][index]) if "joint_support" in columns else False,
        acts_on=_linked(columns, index),
        driver=columns["joint_driver"][index] if "joint_driver" in columns else "",
    )


def _linked(columns: dict[str, list[Any]], index: int) -> tuple[str, str] | None:
    """The bodies on which a joint's force acts, where that are others than its own."""
    first, second = columns["joint_acts_on"][index] if "joint_acts_on" in columns else ("", "")
    return (first, second) if first else None


def _row(columns: dict[str, list[Any]], name: str, index: int) -> tuple[float, ...]:
    """A row of an optional variable; empty where it is missing."""
    row = columns[name][index] if name in columns else []
    return () if np.isnan(row).all() else tuple(row)


def _owned(columns: dict[str, list[Any]], kind: str, owner: int) -> dict[str, Any]:
    """The parameters of one body, joint or instrument; a list becomes a tuple."""
    names = ("owner_kind", "owner_index", "parameter_name", "parameter_index", "value", "lower", "upper", "fixed")
    found: dict[str, Any] = {}
    for row_kind, row_owner, name, index, value, lower, upper, fixed in zip(*(columns[key] for key in names), strict=True):
        if (row_kind, row_owner) == (kind, owner):
            parameter = Parameter(value, lower, upper, bool(fixed))
            found[name] = parameter if index < 0 else (*found.get(name, ()), parameter)
    return found
