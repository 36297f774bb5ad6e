"""What a number in a model file means: its value, its bounds, and whether it is free to be identified."""

import math
from typing import Any

from crashkit.data.validate import names, shown
from crashkit.errors import Fault
from crashkit.model.parameter import Parameter
from crashkit.protocols import ParameterSpec

UNDECLARED = ParameterSpec("", "", "", free=False)
"""Of a number that no plugin declares (a mass, a free length, an instrument's error): plain numbers are fixed."""

_KEYS = ("value", "lower", "upper", "fixed")


def read_parameter(raw: object, spec: ParameterSpec, where: str, faults: list[Fault]) -> Parameter:
    """The parameter that a number, a truth value or a table {value, lower, upper, fixed} of a file stands for.

    A plain number is free where the spec says so, and fixed at the spec's null value; a table is free unless it says
    `fixed = true`, and what bounds it omits are those of the spec; true and false are 1 and 0, fixed.

    Arguments:
        raw: as TOML gives it.
        spec: of the parameter, or UNDECLARED.
        where: the place that faults name.
        faults: what is wrong is added here, and the value returned is NaN.
    """
    if isinstance(raw, dict):
        return _from_table(raw, spec, where, faults)
    if isinstance(raw, bool) and spec.unit == "1":
        return Parameter(float(raw), spec.lower, spec.upper, fixed=True)
    if not is_number(raw):
        faults.append(Fault(where, f"a number, or a table of {names(_KEYS)}", shown(raw)))
        return Parameter(math.nan)
    value = number(raw)
    return Parameter(value, spec.lower, spec.upper, fixed=not spec.free or value == spec.null)


def default_parameter(spec: ParameterSpec) -> Parameter | tuple[Parameter, ...] | None:
    """What a parameter is where a file omits it; None where the file must give it."""
    if spec.default is None:
        return None
    parameter = Parameter(spec.default, spec.lower, spec.upper, fixed=True)
    return (parameter,) if spec.vector else parameter


def write_parameter(parameter: Parameter, spec: ParameterSpec) -> Any:
    """The shortest form that reads back as the same parameter: true or false, a number, or a table."""
    is_switch = spec.unit == "1" and not spec.free and (spec.lower, spec.upper) == (0.0, 1.0)
    table = {
        "value": parameter.value,
        **({"lower": parameter.lower} if parameter.lower != spec.lower else {}),
        **({"upper": parameter.upper} if parameter.upper != spec.upper else {}),
        **({"fixed": True} if parameter.fixed else {}),
    }
    forms = [*([bool(parameter.value)] if is_switch else []), parameter.value]
    return next((form for form in forms if read_parameter(form, spec, "", []) == parameter), table)


def is_number(raw: object) -> bool:
    """Whether TOML gave a number (true and false are none)."""
    return isinstance(raw, int | float) and not isinstance(raw, bool)


def number(raw: Any) -> float:
    """A number of TOML as a float; an integer that no float holds is infinite."""
    return float(str(raw))


def _from_table(table: dict[str, object], spec: ParameterSpec, where: str, faults: list[Fault]) -> Parameter:
    before = len(faults)
    for key, value in table.items():
        if key not in _KEYS:
            faults.append(Fault(where, f"one of {names(_KEYS)}", shown(key)))
        elif key == "fixed" and not isinstance(value, bool):
            faults.append(Fault(where, "fixed as true or false", shown(value)))
        elif key != "fixed" and not is_number(value):
            faults.append(Fault(where, f"{key} as a number", shown(value)))
    if "value" not in table:
        faults.append(Fault(where, 'a table with "value"', f"one with {names(table) or 'nothing'}"))
    if len(faults) > before:
        return Parameter(math.nan)
    lower, upper = number(table.get("lower", spec.lower)), number(table.get("upper", spec.upper))
    return Parameter(number(table["value"]), lower, upper, fixed=table.get("fixed", False) is True)
