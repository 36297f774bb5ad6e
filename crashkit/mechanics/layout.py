"""From a model to the arrays of the kernel: where each parameter of the model sits in them."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from attrs import frozen

from crashkit.data.validate import shown
from crashkit.errors import CrashkitError, did_you_mean
from crashkit.mechanics.given import given_table, imposed_start
from crashkit.mechanics.kernel.arrays import Floats, Integers
from crashkit.mechanics.laws.source import LawFunction
from crashkit.model import Body, Joint, Model, Parameter
from crashkit.model.choice import choice_fault
from crashkit.protocols import Laws, ParameterSpec, SpringLaw

Place = tuple[str, tuple[Any, ...]]
"""The name of an array of the layout, and the index of a parameter in it."""

DOF = {1: 1, 2: 3, 3: 6}
"""Velocities of a body by number of axes: along the axes, then about them."""
INERTIA = {0: (), 1: (2,), 3: (0, 1, 2), 6: (0, 1, 2, 3, 4, 5)}
"""Which of xx, yy, zz, xy, xz, yz a body gives, by how many numbers it gives."""


@frozen
class Layout:
    """A model as indices and numbers.

    Arguments:
        axes: of the model.
        bodies, joints: names.
        ends: (joint, 2) index of each joint's bodies.
        pushed: (joint, 2) index of the bodies on which each joint's force acts.
        functions: of each joint, its law and then its factors.
        drivers: of each function, the index of the joint whose deformation it takes, or -1: its own.
        places: where each parameter sits, by path.
        parameters: the parameter vector.
        offsets: (function + 1) where each function's parameters begin.
        masses: kg by body, infinite for one that no force moves.
        inertia: (body, 6) kg m2 about its own axes: xx, yy, zz, xy, xz, yz; 0 for one that no moment turns.
        points: (joint, 2, axis) m, attachments in their bodies' frames.
        normals: (joint, axis) of each joint's face, in one axis its direction; NaN where it has none.
        free_lengths: m by joint, NaN where it is the distance at t = 0.
        start: (2, body, DOF) positions and velocities at t = 0.
        quaternions: (body, 4) orientations at t = 0.
        given: (knot, 1 + 4 n) what is given, see `Work.given`.
    """

    axes: tuple[str, ...]
    bodies: tuple[str, ...]
    joints: tuple[str, ...]
    ends: Integers
    pushed: Integers
    functions: tuple[tuple[LawFunction, ...], ...]
    drivers: Integers
    places: Mapping[str, Place]
    parameters: Floats
    offsets: Integers
    masses: Floats
    inertia: Floats
    points: Floats
    normals: Floats
    free_lengths: Floats
    start: Floats
    quaternions: Floats
    given: Floats

    def place(self, path: str) -> Place:
        """Where a parameter sits; raises CrashkitError for a path the model does not have."""
        if path not in self.places:
            hint = did_you_mean(path, self.places)
            raise CrashkitError(f"expected a parameter of the model, found {shown(path)}{hint}")
        return self.places[path]

    def declared(self) -> dict[str, ParameterSpec]:
        """What its law declares of each parameter, by path."""
        return {
            path: spec
            for joint, functions in zip(self.joints, self.functions, strict=True)
            for function in functions
            for spec in function.law.parameters
            for path in _paths(f"joint.{joint}.{spec.name}", function.lengths()[spec.name] if spec.vector else None)
        }

    def increasing(self) -> list[list[str]]:
        """The paths of each list of numbers that must increase."""
        return [
            [f"joint.{joint}.{spec.name}[{i}]" for i in range(function.lengths()[spec.name])]
            for joint, functions in zip(self.joints, self.functions, strict=True)
            for function in functions
            for spec in function.law.parameters
            if spec.increasing
        ]


def installed_laws() -> Laws:
    """The spring laws and factors of all plugins."""
    from crashkit.registry import load  # where laws are given, mechanics knows of no plugins

    return load().spring_laws


def lay_out(model: Model, laws: Laws) -> Layout:
    """The layout of a model; raises CrashkitError for what cannot be simulated."""
    count, dof = len(model.axes), DOF[len(model.axes)]
    functions = tuple(tuple(functions_of_joint(joint, laws)) for joint in model.joints)
    parameters: list[float] = []
    offsets = [0]
    slots: dict[str, tuple[int, ...]] = {}
    for joint, own in zip(model.joints, functions, strict=True):
        for function in own:
            for path, value in _entries(joint, function.law):
                slots[path] = (*slots.get(path, ()), len(parameters))
                parameters.append(value)
            offsets.append(len(parameters))
    start, quaternions = _start(model, dof)
    none = ((0.0,) * count,) * 2
    return Layout(
        axes=model.axes,
        bodies=tuple(body.name for body in model.bodies),
        joints=tuple(joint.name for joint in model.joints),
        ends=_indices(model, [joint.bodies for joint in model.joints]),
        pushed=_indices(model, [joint.pushed for joint in model.joints]),
        functions=functions,
        drivers=np.array(list(_drivers(model, functions)), int),
        places={path: ("parameters", (entries,)) for path, entries in slots.items()} | dict(_places(model)),
        parameters=np.array(parameters, float),
        offsets=np.array(offsets),
        masses=np.array([_mass(body) for body in model.bodies]),
        inertia=np.array([_inertia(body, count) for body in model.bodies]),
        points=np.array([joint.points or none for joint in model.joints], float).reshape(-1, 2, count),
        normals=np.array([joint.normal or (np.nan,) * count for joint in model.joints], float).reshape(-1, count),
        free_lengths=np.array([joint.free_length.value if joint.free_length else np.nan for joint in model.joints], float),
        start=start,
        quaternions=quaternions,
        given=given_table(model, dof),
    )


def functions_of(model: Model, laws: Laws) -> frozenset[LawFunction]:
    """The functions that an engine must hold to simulate a model; unite those of several models for one engine."""
    own = [function for joint in model.joints for function in functions_of_joint(joint, laws)]
    return frozenset([*own, *(memory_rate(function) for function in own if function.law.memory)])


def memory_rate(function: LawFunction) -> LawFunction:
    """The function that says how the memory of a law changes."""
    return LawFunction(function.law, function.sizes, "memory_rate")


def functions_of_joint(joint: Joint, laws: Laws) -> Iterator[LawFunction]:
    """The law of a joint and then its factors, with the lengths of their vectors."""
    for name in (joint.law, *joint.factors):
        law = laws.get(name)
        if law is None:
            raise CrashkitError(str(choice_fault(f"joint {joint.name}", "installed laws", name, sorted(laws))))
        expected = "N" if name == joint.law else "1"
        if law.unit != expected:
            raise CrashkitError(f"joint {joint.name}: expected a function with unit {expected}, found {name} with {law.unit}")
        yield LawFunction(law, tuple(len(_vector(joint, spec)) for spec in law.parameters if spec.vector))


def _drivers(model: Model, functions: Sequence[Sequence[LawFunction]]) -> Iterator[int]:
    names = [joint.name for joint in model.joints]
    for joint, own in zip(model.joints, functions, strict=True):
        for function in own:
            if function.law.driven and joint.driver not in names:
                raise CrashkitError(f"joint {joint.name}: expected the joint that drives it, found {joint.driver or 'none'}")
            yield names.index(joint.driver) if function.law.driven else -1


def _entries(joint: Joint, law: type[SpringLaw]) -> Iterator[tuple[str, float]]:
    for spec in law.parameters:
        path = f"joint.{joint.name}.{spec.name}"
        if spec.vector:
            yield from ((f"{path}[{i}]", entry.value) for i, entry in enumerate(_vector(joint, spec)))
        else:
            yield path, _scalar(joint, spec)


def _scalar(joint: Joint, spec: ParameterSpec) -> float:
    value = joint.parameters.get(spec.name)
    if isinstance(value, Parameter):
        return value.value
    if value is None and spec.default is not None:
        return spec.default
    raise CrashkitError(
        f"joint {joint.name}: expected a number for {spec.name}, found {'nothing' if value is None else 'a list'}"
    )


def _vector(joint: Joint, spec: ParameterSpec) -> tuple[Parameter, ...]:
    value = joint.parameters.get(spec.name)
    if isinstance(value, tuple) and value:
        return value
    raise CrashkitError(f"joint {joint.name}: expected a list for {spec.name}, found {'nothing' if not value else 'a number'}")


def _indices(model: Model, pairs: Sequence[tuple[str, str]]) -> Integers:
    """Of two bodies for each joint, (joint, 2)."""
    index = {body.name: i for i, body in enumerate(model.bodies)}
    for joint, pair in zip(model.joints, pairs, strict=True):
        for end in (name for name in pair if name not in index):
            raise CrashkitError(f"joint {joint.name}: expected one of the bodies {', '.join(index)}, found {end}")
    return np.array([[index[end] for end in pair] for pair in pairs], int).reshape(-1, 2)


def _mass(body: Body) -> float:
    if not body.is_free:
        return np.inf
    if body.mass is None:
        raise CrashkitError(f"body {body.name}: expected a mass, found nothing")
    return body.mass.value


def _inertia(body: Body, axes: int) -> Floats:
    values = np.zeros(6)
    if axes > 1 and body.is_free:
        if len(body.inertia) not in ((1,) if axes == 2 else (3, 6)):
            expected = "one number" if axes == 2 else "3 or 6 numbers"
            raise CrashkitError(f"body {body.name}: expected {expected} for inertia, found {len(body.inertia)}")
        values[list(INERTIA[len(body.inertia)])] = [parameter.value for parameter in body.inertia]
    return values


def _start(model: Model, dof: int) -> tuple[Floats, Floats]:
    """Positions, velocities and orientations at t = 0."""
    count = len(model.axes)
    start = np.zeros((2, len(model.bodies), dof))
    quaternions = np.tile([1.0, 0.0, 0.0, 0.0], (len(model.bodies), 1))
    for i, body in enumerate(model.bodies):
        start[0, i, :count], start[1, i, :count] = body.position, body.velocity
        if count == 2 and body.orientation:
            start[0, i, 2] = body.orientation[0]
        if count == 3 and body.orientation:
            quaternions[i] = body.orientation
        if count > 1 and body.angular_velocity:
            start[1, i, count:] = body.angular_velocity
        if body.motion is not None:
            position, velocity, quaternion = imposed_start(body.motion, dof)
            start[0, i, : position.size], start[1, i, : position.size] = position, velocity
            quaternions[i] = quaternions[i] if quaternion is None else quaternion
        if body.fixed:
            start[1, i] = 0.0
    return start, quaternions


def _places(model: Model) -> Iterator[tuple[str, Place]]:
    """Where the parameters that are not of laws sit, by path."""
    count = len(model.axes)
    for b, body in enumerate(model.bodies):
        path = f"body.{body.name}"
        yield f"{path}.mass", ("masses", (b,))
        for name, row in (("position", 0), ("velocity", 1)):
            yield from _indexed(f"{path}.{name}", [("start", (row, b, k)) for k in range(count)])
        if count > 1:
            yield from _indexed(f"{path}.inertia", [("inertia", (b, k)) for k in INERTIA[len(body.inertia)]])
            for name, row in (("rotation", 0), ("angular_velocity", 1)):
                yield from _indexed(f"{path}.{name}", [("start", (row, b, k)) for k in range(count, DOF[count])])
    for j, joint in enumerate(model.joints):
        yield f"joint.{joint.name}.free_length", ("free_lengths", (j,))
        for end in range(2):
            yield from _indexed(f"joint.{joint.name}.points[{end}]", [("points", (j, end, k)) for k in range(count)])


def _paths(path: str, length: int | None) -> list[str]:
    """Of one number, or of each in a list."""
    return [path] if length is None else [f"{path}[{i}]" for i in range(length)]


def _indexed(path: str, places: list[Place]) -> Iterator[tuple[str, Place]]:
    """One number has the path itself, several have it with an index."""
    if len(places) == 1:
        yield path, places[0]
    else:
        yield from ((f"{path}[{i}]", place) for i, place in enumerate(places))
