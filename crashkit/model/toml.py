"""Models as TOML: what people read and write."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from attrs import evolve

from crashkit.data.files import atomic_write
from crashkit.errors import ContractError, CrashkitError, Fault
from crashkit.model.body import Body
from crashkit.model.checks import check_model, instrument_place, model_faults, place, specs_of
from crashkit.model.given import GivenForce, GivenMotion, Rows
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.parameter import Parameter
from crashkit.model.pose import normalised
from crashkit.model.toml_tables import BODY, FORCE, INSTRUMENT, JOINT, MOTION, ROOT, section
from crashkit.model.toml_text import SCHEMA, model_to_toml
from crashkit.model.values import UNDECLARED, default_parameter, number, read_parameter
from crashkit.protocols import Laws, Observer, ParameterSpec

__all__ = ["SCHEMA", "model_to_toml", "read_model", "write_model"]


def read_model(path: str | Path, laws: Laws, observers: Mapping[str, type[Observer]] | None = None) -> Model:
    """A model from a TOML file, checked.

    Arguments:
        path: the file.
        laws: the installed laws and factors by name.
        observers: the installed observers by name; if given, instrument errors must be declared by one of them.

    Raises:
        ContractError: with every fault, if it is no model that can be simulated.
        CrashkitError: if it cannot be read at all.
    """
    faults: list[Fault] = []
    model = _model(_load(Path(path)), laws, faults)
    reported = {fault.place for fault in faults}
    faults += [fault for fault in model_faults(model, laws, observers) if fault.place not in reported]
    if faults:
        raise ContractError(str(path), faults)
    return model


def write_model(model: Model, path: str | Path, laws: Laws) -> None:
    """Write a model as TOML, whole or not at all; `read_model` gives back the same model.

    Raises:
        ContractError: with every fault, if it is no model that can be simulated.
        CrashkitError: if the file cannot be written.
    """
    check_model(model, laws, str(path))
    text = model_to_toml(model, laws)
    atomic_write(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def _load(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            return tomllib.load(file)
    except OSError as error:
        raise CrashkitError(f"{path}: expected a model file, found {(error.strerror or str(error)).lower()}") from error
    except UnicodeDecodeError as error:
        raise CrashkitError(f"{path}: expected a model file (TOML), found one that is no text") from error
    except (ValueError, RecursionError) as error:
        reason = str(error)
        raise CrashkitError(f"{path}: expected TOML, found a fault in it: {reason[:1].lower()}{reason[1:]}") from error


def _model(table: dict[str, Any], laws: Laws, faults: list[Fault]) -> Model:
    root = section(table, ROOT, ("schema", "name", "axes"), "", faults)
    axes = tuple(root.get("axes", ["x"]))
    return Model(
        name=root.get("name", ""),
        axes=axes,
        gravity=_floats(root.get("gravity", [])),
        bodies=tuple(_body(entry, len(axes), index, faults) for index, entry in enumerate(root.get("body", []))),
        joints=tuple(_joint(entry, laws, index, faults) for index, entry in enumerate(root.get("joint", []))),
        instruments=tuple(_instrument(entry, index, faults) for index, entry in enumerate(root.get("instrument", []))),
    )


def _body(table: dict[str, Any], axes: int, index: int, faults: list[Fault]) -> Body:
    where = _place("body", index, table.get("name"))
    body = section(table, BODY, ("name",) if "motion" in table else ("name", "position"), where, faults)
    motion = _motion(body["motion"], f"{where}/motion", faults) if "motion" in body else None
    return Body(
        name=body.get("name", ""),
        position=_floats(body["position"]) if "position" in body else _at_start(motion, axes),
        velocity=_floats(body.get("velocity", [0.0] * axes)),
        mass=_positive(body["mass"], f"{where}/mass", faults) if "mass" in body else None,
        fixed=body.get("fixed", False),
        carrier=body.get("carrier", ""),
        inertia=_inertia(body["inertia"], axes, f"{where}/inertia", faults) if "inertia" in body else (),
        orientation=_unit_quaternion(_floats(body.get("orientation", []))),
        angular_velocity=_floats(body.get("angular_velocity", [])),
        motion=motion,
        force=_force(body["force"], f"{where}/force", faults) if "force" in body else None,
    )


def _at_start(motion: GivenMotion | None, axes: int) -> tuple[float, ...]:
    """The place at t = 0 that a given motion tells of a body whose table does not say it."""
    if motion is None:
        return ()
    times, rows = len(motion.time), motion.position
    if times != len(rows) or times == 0 or any(len(row) != axes for row in rows):  # faults that the motion's check tells
        return (0.0,) * axes
    return tuple(float(np.interp(0.0, motion.time, column)) for column in zip(*rows, strict=True))


def _motion(table: dict[str, Any], where: str, faults: list[Fault]) -> GivenMotion:
    motion = section(table, MOTION, ("time", "position"), where, faults)
    orientation = tuple(_unit_quaternion(row) for row in _rows(motion.get("orientation", [])))
    return GivenMotion(_floats(motion.get("time", [])), _rows(motion.get("position", [])), orientation)


def _force(table: dict[str, Any], where: str, faults: list[Fault]) -> GivenForce:
    force = section(table, FORCE, ("time", "force"), where, faults)
    return GivenForce(_floats(force.get("time", [])), _rows(force.get("force", [])), _rows(force.get("moment", [])))


def _positive(raw: object, where: str, faults: list[Fault]) -> Parameter:
    """A mass or a moment of inertia; free, it stays above 0."""
    parameter = read_parameter(raw, UNDECLARED, where, faults)
    return parameter if parameter.fixed else evolve(parameter, lower=max(parameter.lower, 0.0))


def _inertia(raw: object, axes: int, where: str, faults: list[Fault]) -> tuple[Parameter, ...]:
    """The moments and products of inertia; in space one plain number holds about every axis."""
    if not isinstance(raw, list):
        alike = 3 if axes == 3 and not isinstance(raw, dict) else 1
        return (_positive(raw, where, faults),) * alike
    moments = [_positive(entry, f"{where}[{index}]", faults) for index, entry in enumerate(raw[:3])]
    products = [read_parameter(entry, UNDECLARED, f"{where}[{index}]", faults) for index, entry in enumerate(raw[3:], 3)]
    return (*moments, *products)


def _unit_quaternion(orientation: tuple[float, ...]) -> tuple[float, ...]:
    """An orientation in space as a unit quaternion; an angle as it is."""
    return normalised(orientation) if len(orientation) == 4 else orientation


def _joint(table: dict[str, Any], laws: Laws, index: int, faults: list[Fault]) -> Joint:
    where = _place("joint", index, table.get("name"))
    joint = section(table, JOINT, ("name", "bodies", "law"), where, faults)
    law, factors = joint.get("law", ""), tuple(joint.get("factors", ()))
    first, second = joint.get("bodies", ("", ""))
    points = joint.get("points")
    return Joint(
        name=joint.get("name", ""),
        bodies=(first, second),
        law=law,
        parameters=_parameters(joint.get("parameters", {}), specs_of(law, factors, laws), where, faults),
        factors=factors,
        points=(_floats(points[0]), _floats(points[1])) if points else None,
        free_length=_free_length(joint.get("free_length"), f"{where}/free_length", faults),
        normal=normalised(_floats(joint["normal"])) if "normal" in joint else None,
        support=joint.get("support", False),
        driver=joint.get("driver", ""),
        acts_on=(joint["acts_on"][0], joint["acts_on"][1]) if "acts_on" in joint else None,
    )


def _free_length(raw: object, where: str, faults: list[Fault]) -> Parameter | None:
    return None if raw is None else read_parameter(raw, UNDECLARED, where, faults)


def _parameters(
    table: dict[str, Any], specs: Mapping[str, ParameterSpec], where: str, faults: list[Fault]
) -> dict[str, Parameter | tuple[Parameter, ...]]:
    """Given and default values in the order in which the law and its factors declare them."""
    found: dict[str, Parameter | tuple[Parameter, ...]] = {}
    for name in dict.fromkeys([*specs, *table]):
        value = (
            _value(table[name], specs.get(name, UNDECLARED), f"{where}/{name}", faults)
            if name in table
            else default_parameter(specs[name])
        )
        if value is not None:
            found[name] = value
    return found


def _value(raw: object, spec: ParameterSpec, where: str, faults: list[Fault]) -> Parameter | tuple[Parameter, ...]:
    if not isinstance(raw, list):
        return read_parameter(raw, spec, where, faults)
    return tuple(read_parameter(entry, spec, f"{where}[{index}]", faults) for index, entry in enumerate(raw))


def _instrument(table: dict[str, Any], index: int, faults: list[Fault]) -> InstrumentErrors:
    group, sensor = table.get("group"), table.get("sensor", "")
    where = instrument_place(group, str(sensor)) if isinstance(group, str) and group else f"instrument[{index}]"
    entry = section(table, INSTRUMENT, ("group",), where, faults)
    parameters = {
        name: read_parameter(raw, UNDECLARED, f"{where}/{name}", faults) for name, raw in entry.get("parameters", {}).items()
    }
    return InstrumentErrors(entry.get("group", ""), entry.get("sensor", ""), parameters)


def _place(kind: str, index: int, name: object) -> str:
    return place(kind, index, name if isinstance(name, str) else "")


def _floats(values: Any) -> tuple[float, ...]:
    """A list of numbers, or a single one."""
    return tuple(number(value) for value in (values if isinstance(values, list) else [values]))


def _rows(rows: list[Any]) -> Rows:
    return tuple(_floats(row) for row in rows)
