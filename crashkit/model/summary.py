"""A model in a few lines, as Python shows it."""

from collections.abc import Sequence
from itertools import chain

from crashkit.model.body import Body
from crashkit.model.joint import Joint
from crashkit.model.parameter import Parameter

LINES = 4
"""Bodies, and joints, that are told one by one."""


def head_of(name: str, axes: Sequence[str], bodies: Sequence[Body], joints: Sequence[Joint]) -> str:
    """The parts of a model, in a line."""
    parts = ((len(bodies), "body", "bodies"), (len(joints), "joint", "joints"))
    counts = ", ".join(f"{count} {one if count == 1 else more}" for count, one, more in parts)
    return f'model "{name}" in {" ".join(axes)}: {counts}'


def lines_of(bodies: Sequence[Body], joints: Sequence[Joint]) -> list[str]:
    """Each body and each joint in a line, as long as they are few."""
    return [*_first([_body(body) for body in bodies], "bodies"), *_first([_joint(joint) for joint in joints], "joints")]


def _first(lines: list[str], noun: str) -> list[str]:
    more = len(lines) - LINES
    return lines if more <= 0 else [*lines[: LINES - 1], f"  ... and {more + 1} more {noun}"]


def _body(body: Body) -> str:
    if body.fixed:
        return f"  body {body.name}: fixed"
    mass = f"{body.mass.value:g} kg, " if body.mass else ""
    moves = "driven" if body.motion else f"at {_numbers(body.position)} m, {_numbers(body.velocity)} m s-1"
    return f"  body {body.name}: {mass}{moves}"


def _joint(joint: Joint) -> str:
    parameters = list(chain.from_iterable(map(_entries, joint.parameters.values())))
    free = sum(not parameter.fixed for parameter in parameters)
    laws = " * ".join((joint.law, *joint.factors))
    return f"  joint {joint.name} ({' - '.join(joint.bodies)}): {laws}, {free} of {len(parameters)} numbers free"


def _entries(value: Parameter | tuple[Parameter, ...]) -> tuple[Parameter, ...]:
    return (value,) if isinstance(value, Parameter) else value


def _numbers(values: Sequence[float]) -> str:
    return f"{values[0]:g}" if len(values) == 1 else f"({', '.join(f'{value:g}' for value in values)})"
