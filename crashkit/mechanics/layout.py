"""From a model to the arrays of the kernel: where each parameter of the model sits in them."""

from collections.abc import Iterator, Mapping

import numpy as np
from attrs import frozen

from crashkit.errors import CrashkitError
from crashkit.mechanics.law_source import LawFunction
from crashkit.model import Joint, Model, Parameter
from crashkit.protocols import ParameterSpec, SpringLaw

Laws = Mapping[str, type[SpringLaw]]


@frozen
class Layout:
    """A model in one axis as indices and numbers.

    Arguments:
        bodies, joints: names.
        ends: (joint, 2) index of each joint's bodies.
        functions: of each joint, its law and then its factors.
        slots: entries of the parameter vector that each parameter of a joint fills, by path.
        parameters: the parameter vector.
        offsets: (function + 1) where each function's parameters begin.
        masses: kg by body, infinite for a fixed one.
        points: (joint, 2) m, attachment from the centres of mass.
        free_lengths: m by joint, NaN where it is the distance at t = 0.
        position, velocity: by body, at t = 0.
    """

    bodies: tuple[str, ...]
    joints: tuple[str, ...]
    ends: np.ndarray
    functions: tuple[tuple[LawFunction, ...], ...]
    slots: Mapping[str, tuple[int, ...]]
    parameters: np.ndarray
    offsets: np.ndarray
    masses: np.ndarray
    points: np.ndarray
    free_lengths: np.ndarray
    position: np.ndarray
    velocity: np.ndarray


def lay_out(model: Model, laws: Laws) -> Layout:
    """The layout of a model; raises CrashkitError for what cannot be simulated."""
    if len(model.axes) != 1:
        raise CrashkitError(f"model {model.name}: expected one axis, found {', '.join(model.axes)}")
    index = {body.name: i for i, body in enumerate(model.bodies)}
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
    return Layout(
        bodies=tuple(index),
        joints=tuple(joint.name for joint in model.joints),
        ends=np.array([[_index(joint, end, index) for end in joint.bodies] for joint in model.joints], int).reshape(-1, 2),
        functions=functions,
        slots=slots,
        parameters=np.array(parameters, float),
        offsets=np.array(offsets),
        masses=np.array([_mass(body.name, body.mass, body.fixed) for body in model.bodies]),
        points=np.array([joint.points or ((0.0,), (0.0,)) for joint in model.joints], float).reshape(-1, 2),
        free_lengths=np.array([joint.free_length.value if joint.free_length else np.nan for joint in model.joints], float),
        position=np.array([body.position[0] for body in model.bodies], float),
        velocity=np.array([body.velocity[0] for body in model.bodies], float),
    )


def functions_of(model: Model, laws: Laws) -> frozenset[LawFunction]:
    """The functions that an engine must hold to simulate a model; unite those of several models for one engine."""
    return frozenset(function for joint in model.joints for function in functions_of_joint(joint, laws))


def functions_of_joint(joint: Joint, laws: Laws) -> Iterator[LawFunction]:
    """The law of a joint and then its factors, with the lengths of their vectors."""
    for name in (joint.law, *joint.factors):
        law = laws.get(name)
        if law is None:
            raise CrashkitError(
                f"joint {joint.name}: expected a law that is installed ({', '.join(sorted(laws))}), found {name}"
            )
        expected = "N" if name == joint.law else "1"
        if law.unit != expected:
            raise CrashkitError(f"joint {joint.name}: expected a function with unit {expected}, found {name} with {law.unit}")
        yield LawFunction(law, tuple(len(_vector(joint, spec)) for spec in law.parameters if spec.vector))


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


def _index(joint: Joint, end: str, index: Mapping[str, int]) -> int:
    if end not in index:
        raise CrashkitError(f"joint {joint.name}: expected one of the bodies {', '.join(index)}, found {end}")
    return index[end]


def _mass(name: str, mass: Parameter | None, fixed: bool) -> float:
    if fixed:
        return np.inf
    if mass is None:
        raise CrashkitError(f"body {name}: expected a mass, found nothing")
    return mass.value
