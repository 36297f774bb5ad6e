"""What the tables of a model file may hold: the keys, and what each looks like."""

from collections.abc import Callable, Mapping
from typing import Any

from attrs import frozen

from crashkit.data.validate import shown
from crashkit.errors import Fault
from crashkit.model.choice import choice_fault
from crashkit.model.toml_text import SCHEMA
from crashkit.model.values import is_number


@frozen
class Kind:
    """What a key of a file may hold."""

    expected: str
    fits: Callable[[Any], bool]


def _list_of(fits: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda raw: isinstance(raw, list) and all(fits(entry) for entry in raw)


def _pair_of(fits: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda raw: _list_of(fits)(raw) and len(raw) == 2


def _either(one: Callable[[Any], bool], other: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda raw: one(raw) or other(raw)


def _is_text(raw: object) -> bool:
    return isinstance(raw, str)


def _is_table(raw: object) -> bool:
    return isinstance(raw, dict)


_TEXT = Kind("text", _is_text)
_TEXTS = Kind("a list of text", _list_of(_is_text))
_SCHEMA = Kind(shown(SCHEMA), lambda raw: raw == SCHEMA)
_AXES = Kind('a list of text such as ["x"]', _list_of(_is_text))
_FLAG = Kind("true or false", lambda raw: isinstance(raw, bool))
_NUMBERS = Kind("a list of numbers", _list_of(is_number))
_NUMBER_OR_NUMBERS = Kind("a number or a list of numbers", _either(is_number, _list_of(is_number)))
_ROWS = Kind("a list of numbers, or of lists of numbers", _list_of(_either(is_number, _list_of(is_number))))
_NAMES = Kind("the names of two bodies", _pair_of(_is_text))
_POINTS = Kind("two lists of numbers", _pair_of(_list_of(is_number)))
_TABLE = Kind("a table", _is_table)
_TABLES = Kind("tables in double brackets", _list_of(_is_table))
_ANY = Kind("a number", lambda raw: True)

ROOT = {
    "schema": _SCHEMA,
    "name": _TEXT,
    "axes": _AXES,
    "gravity": _NUMBERS,
    "body": _TABLES,
    "joint": _TABLES,
    "instrument": _TABLES,
}
BODY = {
    "name": _TEXT,
    "fixed": _FLAG,
    "mass": _ANY,
    "inertia": _ANY,
    "position": _NUMBERS,
    "orientation": _NUMBER_OR_NUMBERS,
    "velocity": _NUMBERS,
    "angular_velocity": _NUMBER_OR_NUMBERS,
    "carrier": _TEXT,
    "motion": _TABLE,
    "force": _TABLE,
}
MOTION = {"time": _NUMBERS, "position": _ROWS, "orientation": _ROWS}
FORCE = {"time": _NUMBERS, "force": _ROWS, "moment": _ROWS}
JOINT = {
    "name": _TEXT,
    "bodies": _NAMES,
    "points": _POINTS,
    "normal": _NUMBERS,
    "free_length": _ANY,
    "support": _FLAG,
    "acts_on": _NAMES,
    "driver": _TEXT,
    "law": _TEXT,
    "factors": _TEXTS,
    "parameters": _TABLE,
}
INSTRUMENT = {"group": _TEXT, "sensor": _TEXT, "parameters": _TABLE}


def section(
    table: dict[str, Any], kinds: Mapping[str, Kind], required: tuple[str, ...], where: str, faults: list[Fault]
) -> dict[str, Any]:
    """The entries of a table that are as they should be; what is not is added to the faults."""
    prefix = f"{where}/" if where else ""
    faults.extend(choice_fault(where or "model", "keys", key, kinds) for key in table if key not in kinds)
    faults.extend(Fault(f"{prefix}{key}", kinds[key].expected, "none") for key in required if key not in table)
    wrong = [key for key in table if key in kinds and not kinds[key].fits(table[key])]
    faults.extend(Fault(f"{prefix}{key}", kinds[key].expected, shown(table[key])) for key in wrong)
    return {key: value for key, value in table.items() if key in kinds and key not in wrong}
