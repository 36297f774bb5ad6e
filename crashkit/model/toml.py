"""Models as TOML: what people read and write."""

import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from attrs import evolve, frozen

from crashkit.data.files import atomic_write
from crashkit.data.validate import names, shown
from crashkit.errors import ContractError, CrashkitError, Fault
from crashkit.model.body import Body
from crashkit.model.checks import check_model, instrument_place, model_faults, place, specs_of
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.parameter import Parameter
from crashkit.model.toml_text import SCHEMA, model_to_toml
from crashkit.model.values import UNDECLARED, default_parameter, is_number, number, read_parameter
from crashkit.protocols import Observer, ParameterSpec, SpringLaw

__all__ = ["SCHEMA", "model_to_toml", "read_model", "write_model"]


def read_model(
    path: str | Path, laws: Mapping[str, type[SpringLaw]], observers: Mapping[str, type[Observer]] | None = None
) -> Model:
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


def write_model(model: Model, path: str | Path, laws: Mapping[str, type[SpringLaw]]) -> None:
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
    except (ValueError, RecursionError) as error:
        reason = str(error)
        raise CrashkitError(f"{path}: expected TOML, found a fault in it: {reason[:1].lower()}{reason[1:]}") from error


@frozen
class _Kind:
    """What a key of a file may hold."""

    expected: str
    fits: Callable[[Any], bool]


def _list_of(fits: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda raw: isinstance(raw, list) and all(fits(entry) for entry in raw)


def _pair_of(fits: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda raw: _list_of(fits)(raw) and len(raw) == 2


def _is_text(raw: object) -> bool:
    return isinstance(raw, str)


def _is_table(raw: object) -> bool:
    return isinstance(raw, dict)


_TEXT = _Kind("text", _is_text)
_TEXTS = _Kind("a list of text", _list_of(_is_text))
_FLAG = _Kind("true or false", lambda raw: isinstance(raw, bool))
_NUMBERS = _Kind("a list of numbers", _list_of(is_number))
_NAMES = _Kind("the names of two bodies", _pair_of(_is_text))
_POINTS = _Kind("two lists of numbers", _pair_of(_list_of(is_number)))
_TABLE = _Kind("a table", _is_table)
_TABLES = _Kind("tables in double brackets", _list_of(_is_table))
_ANY = _Kind("a number", lambda raw: True)

_ROOT = {"schema": _TEXT, "name": _TEXT, "axes": _TEXTS, "body": _TABLES, "joint": _TABLES, "instrument": _TABLES}
_BODY = {"name": _TEXT, "fixed": _FLAG, "mass": _ANY, "position": _NUMBERS, "velocity": _NUMBERS, "carrier": _TEXT}
_JOINT = {
    "name": _TEXT,
    "bodies": _NAMES,
    "points": _POINTS,
    "free_length": _ANY,
    "law": _TEXT,
    "factors": _TEXTS,
    "parameters": _TABLE,
}
_INSTRUMENT = {"group": _TEXT, "sensor": _TEXT, "parameters": _TABLE}


def _section(
    table: dict[str, Any], kinds: Mapping[str, _Kind], required: tuple[str, ...], where: str, faults: list[Fault]
) -> dict[str, Any]:
    """The entries of a table that are as they should be; what is not is added to the faults."""
    prefix = f"{where}/" if where else ""
    faults.extend(Fault(where or "model", f"one of {names(kinds)}", shown(key)) for key in table if key not in kinds)
    faults.extend(Fault(f"{prefix}{key}", kinds[key].expected, "none") for key in required if key not in table)
    wrong = [key for key in table if key in kinds and not kinds[key].fits(table[key])]
    faults.extend(Fault(f"{prefix}{key}", kinds[key].expected, shown(table[key])) for key in wrong)
    return {key: value for key, value in table.items() if key in kinds and key not in wrong}


def _model(table: dict[str, Any], laws: Mapping[str, type[SpringLaw]], faults: list[Fault]) -> Model:
    root = _section(table, _ROOT, ("schema", "name", "axes"), "", faults)
    if root.get("schema", SCHEMA) != SCHEMA:
        faults.append(Fault("schema", shown(SCHEMA), shown(root["schema"])))
    axes = tuple(root.get("axes", ["x"]))
    return Model(
        name=root.get("name", ""),
        axes=axes,
        bodies=tuple(_body(entry, len(axes), index, faults) for index, entry in enumerate(root.get("body", []))),
        joints=tuple(_joint(entry, laws, index, faults) for index, entry in enumerate(root.get("joint", []))),
        instruments=tuple(_instrument(entry, index, faults) for index, entry in enumerate(root.get("instrument", []))),
    )


def _body(table: dict[str, Any], axes: int, index: int, faults: list[Fault]) -> Body:
    where = _place("body", index, table.get("name"))
    body = _section(table, _BODY, ("name", "position"), where, faults)
    return Body(
        name=body.get("name", ""),
        position=_floats(body.get("position", [])),
        velocity=_floats(body.get("velocity", [0.0] * axes)),
        mass=_mass(body["mass"], f"{where}/mass", faults) if "mass" in body else None,
        fixed=body.get("fixed", False),
        carrier=body.get("carrier", ""),
    )


def _mass(raw: object, where: str, faults: list[Fault]) -> Parameter:
    mass = read_parameter(raw, UNDECLARED, where, faults)
    return mass if mass.fixed else evolve(mass, lower=max(mass.lower, 0.0))


def _joint(table: dict[str, Any], laws: Mapping[str, type[SpringLaw]], index: int, faults: list[Fault]) -> Joint:
    where = _place("joint", index, table.get("name"))
    joint = _section(table, _JOINT, ("name", "bodies", "law"), where, faults)
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
    entry = _section(table, _INSTRUMENT, ("group",), where, faults)
    parameters = {
        name: read_parameter(raw, UNDECLARED, f"{where}/{name}", faults) for name, raw in entry.get("parameters", {}).items()
    }
    return InstrumentErrors(entry.get("group", ""), entry.get("sensor", ""), parameters)


def _place(kind: str, index: int, name: object) -> str:
    return place(kind, index, name if isinstance(name, str) else "")


def _floats(values: list[Any]) -> tuple[float, ...]:
    return tuple(number(value) for value in values)
