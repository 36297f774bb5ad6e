"""The TOML text of a model, laid out as a person would write it."""

from collections.abc import Mapping, Sequence
from typing import Any

import tomli_w

from crashkit.model.body import Body
from crashkit.model.given import GivenForce, GivenMotion
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.joint_checks import specs_of
from crashkit.model.model import Model
from crashkit.model.parameter import Parameter
from crashkit.model.values import UNDECLARED, default_parameter, write_parameter
from crashkit.protocols import Laws, ParameterSpec

SCHEMA = "crashkit-model/1"


def model_to_toml(model: Model, laws: Laws) -> str:
    """A model as TOML: plain numbers where they say it all, tables where bounds or freedom differ from what the law declares.

    Arguments:
        model: to be written.
        laws: the installed laws and factors by name, which declare the parameters.
    """
    sections = [
        _lines({"schema": SCHEMA, "name": model.name, "axes": model.axes, **_given(gravity=model.gravity)}),
        *(_body(body) for body in model.bodies),
        *(_joint(joint, laws) for joint in model.joints),
        *(_instrument(errors) for errors in model.instruments),
    ]
    return "\n".join(sections)


def _body(body: Body) -> str:
    head = {
        "name": body.name,
        **({"fixed": True} if body.fixed else {}),
        **({"mass": write_parameter(body.mass, UNDECLARED)} if body.mass is not None else {}),
        **_given(inertia=_single([write_parameter(entry, UNDECLARED) for entry in body.inertia])),
        "position": body.position,
        **_given(orientation=_single(body.orientation)),
        **({"velocity": body.velocity} if any(body.velocity) or body.is_free else {}),
        **_given(angular_velocity=_single(body.angular_velocity), carrier=body.carrier),
    }
    return f"[[body]]\n{_lines(head)}{_motion(body.motion)}{_force(body.force)}"


def _motion(motion: GivenMotion | None) -> str:
    if motion is None:
        return ""
    orientation = f"orientation = {_rows(_singles(motion.orientation))}\n" if motion.orientation else ""
    return f"[body.motion]\ntime = {_inline(motion.time)}\nposition = {_rows(motion.position)}\n{orientation}"


def _force(force: GivenForce | None) -> str:
    if force is None:
        return ""
    moment = f"moment = {_rows(_singles(force.moment))}\n" if force.moment else ""
    return f"[body.force]\ntime = {_inline(force.time)}\nforce = {_rows(force.force)}\n{moment}"


def _given(**entries: Any) -> dict[str, Any]:
    """Entries that are not empty; an empty one is what the reader gives to one that is not there."""
    return {key: value for key, value in entries.items() if value not in ((), [], "")}


def _single(values: Sequence[Any]) -> Any:
    """What has one number in the plane, several in space."""
    return values[0] if len(values) == 1 else values


def _singles(rows: Sequence[Sequence[float]]) -> list[Any]:
    return [_single(row) for row in rows]


def _rows(rows: Sequence[Any]) -> str:
    """A list with each row on a line of its own; numbers, which are no rows, on one."""
    if any(isinstance(row, list | tuple) for row in rows):
        return "[\n" + "".join(f"    {_inline(row)},\n" for row in rows) + "]"
    return _inline(rows)


def _joint(joint: Joint, laws: Laws) -> str:
    head = {
        "name": joint.name,
        "bodies": joint.bodies,
        **({"points": joint.points} if joint.points is not None else {}),
        **({"normal": joint.normal} if joint.normal is not None else {}),
        **({"free_length": write_parameter(joint.free_length, UNDECLARED)} if joint.free_length is not None else {}),
        **({"support": True} if joint.support else {}),
        **({"acts_on": joint.acts_on} if joint.acts_on else {}),
        **({"driver": joint.driver} if joint.driver else {}),
        "law": joint.law,
        **({"factors": joint.factors} if joint.factors else {}),
    }
    specs = specs_of(joint.law, joint.factors, laws)
    parameters = "".join(_parameter(name, value, specs.get(name, UNDECLARED)) for name, value in joint.parameters.items())
    return f"[[joint]]\n{_lines(head)}[joint.parameters]\n{parameters}"


def _parameter(name: str, value: Parameter | tuple[Parameter, ...], spec: ParameterSpec) -> str:
    raw = _raw(value, spec)
    if isinstance(raw, dict) and value == default_parameter(spec):
        return ""
    unit = f"  # {spec.unit}" if spec.unit not in ("", "1") else ""
    return f"{_line(name, raw)}{unit}\n"


def _raw(value: Parameter | tuple[Parameter, ...], spec: ParameterSpec) -> Any:
    if isinstance(value, Parameter):
        return write_parameter(value, spec)
    return [write_parameter(entry, spec) for entry in value]


def _instrument(errors: InstrumentErrors) -> str:
    head = {"group": errors.instrument, **({"sensor": errors.sensor} if errors.sensor else {})}
    parameters = {name: write_parameter(parameter, UNDECLARED) for name, parameter in errors.parameters.items()}
    return f"[[instrument]]\n{_lines(head)}[instrument.parameters]\n{_lines(parameters)}"


def _lines(table: Mapping[str, Any]) -> str:
    return "".join(f"{_line(key, value)}\n" for key, value in table.items())


def _line(key: str, value: Any) -> str:
    """`key = value`; tomli_w spreads lists and tables over many lines, so those are written here."""
    if isinstance(value, list | tuple | dict):
        name = tomli_w.dumps({key: 0}).removesuffix(" = 0\n")
        return f"{name} = {_inline(value)}"
    return tomli_w.dumps({key: value}).rstrip("\n")


def _inline(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(_line(key, entry) for key, entry in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(_inline(entry) for entry in value)}]"
    return _line("x", value).removeprefix("x = ")
