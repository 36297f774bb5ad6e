"""What a joint must fulfil before it can be simulated."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np

from crashkit.data.validate import names, shown
from crashkit.errors import Fault, claimed_twice
from crashkit.model.body import Body
from crashkit.model.choice import choice_fault
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.number_checks import parameter_faults, vector_faults
from crashkit.model.parameter import Parameter
from crashkit.model.pose import ORIENTATION, is_unit, laboratory_point
from crashkit.protocols import Laws, ParameterSpec

SIGN = re.compile(r" [+~*|&%/] ")
"""Between the names of laws that are combined."""
APART = 1e-9
"""m, the least distance of two attachments that gives the line between them a direction."""


def joint_faults(joint: Joint, model: Model, laws: Laws, where: str) -> Iterator[Fault]:
    """Every fault of a joint of the model; `where` names it."""
    known = list(dict.fromkeys(body.name for body in model.bodies if body.name))
    yield from _pair_faults(joint.bodies, known, f"{where}/bodies")
    yield from _pair_faults(joint.pushed, known, f"{where}/acts_on") if joint.acts_on else ()
    yield from _geometry_faults(joint, model, where)
    yield from _driver_faults(joint, model, laws, where)
    if joint.free_length is not None:
        yield from parameter_faults(joint.free_length, None, f"{where}/free_length")
    yield from _law_faults(joint.law, "N", laws, f"{where}/law")
    for factor in joint.factors:
        yield from _law_faults(factor, "1", laws, f"{where}/factors")
    yield from _joint_parameter_faults(joint, laws, where)


def specs_of(law: str, factors: Iterable[str], laws: Laws) -> dict[str, ParameterSpec]:
    """The parameters that a law and its factors declare, by name, in their order; what is not installed declares none."""
    installed = [laws[name] for name in (law, *factors) if name in laws]
    return {spec.name: spec for plugin in installed for spec in plugin.parameters}


def has_no_direction(joint: Joint, bodies: Mapping[str, Body], axes: int) -> bool:
    """Whether the attachments of a line meet at t = 0; False where their places are not known: that is another fault."""
    if axes == 1 or joint.normal is not None:
        return False
    ends = [bodies.get(name) for name in joint.bodies]
    points = joint.points or ((0.0,) * axes, (0.0,) * axes)
    places = [
        laboratory_point(body, point)
        for body, point in zip(ends, points, strict=True)
        if body is not None and body.motion is None and _is_placed(body, point, axes)
    ]
    return len(places) == 2 and float(np.linalg.norm(places[0] - places[1])) < APART


def _is_placed(body: Body, point: Sequence[float], axes: int) -> bool:
    numbers = (*body.position, *body.orientation, *point)
    lengths = len(body.position), len(point), len(body.orientation) or ORIENTATION.get(axes)
    return lengths == (axes, axes, ORIENTATION.get(axes)) and all(map(math.isfinite, numbers))


def _driver_faults(joint: Joint, model: Model, laws: Laws, where: str) -> Iterator[Fault]:
    others = [other.name for other in model.joints if other.name not in ("", joint.name)]
    driven = [name for name in (joint.law, *joint.factors) if name in laws and laws[name].driven]
    if joint.driver not in (*others, "") or (driven and not joint.driver):
        reason = f", which {names(driven)} depends on" if driven else ""
        yield Fault(f"{where}/driver", f"one of the other joints ({names(others) or 'none'}){reason}", shown(joint.driver))


def _pair_faults(pair: tuple[str, str], known: Sequence[str], where: str) -> Iterator[Fault]:
    for name in pair:
        if name not in known:
            yield Fault(where, f"one of {names(known)}", shown(name))
    if pair[0] == pair[1]:
        yield Fault(where, "two different bodies", f"{shown(pair[0])} twice")


def _geometry_faults(joint: Joint, model: Model, where: str) -> Iterator[Fault]:
    axes = len(model.axes)
    for point in joint.points or ():
        yield from vector_faults(point, axes, f"{where}/points")
    if joint.support and axes > 1:
        yield Fault(f"{where}/support", "none but in one axis", "true")
    if joint.acts_on and axes > 1:
        yield Fault(f"{where}/acts_on", "none but in one axis", names(joint.acts_on))
    if joint.normal is not None and axes == 1:
        yield Fault(f"{where}/normal", "none in one axis", names(joint.normal))
    elif joint.normal is not None:
        faults = list(vector_faults(joint.normal, axes, f"{where}/normal"))
        yield from faults
        if not faults and not is_unit(joint.normal):
            yield Fault(f"{where}/normal", "a vector of length 1", f"one of length {math.hypot(*joint.normal):.9g}")
    elif has_no_direction(joint, {body.name: body for body in model.bodies}, axes):
        expected = "attachments apart at t = 0, or a normal (the line between them has no direction)"
        yield Fault(f"{where}/points", expected, "both in one place")


def _law_faults(name: str, unit: str, laws: Laws, where: str) -> Iterator[Fault]:
    if name in laws and laws[name].unit == unit:
        return
    kind = "laws" if unit == "N" else "factors"
    installed = sorted(law for law, plugin in laws.items() if plugin.unit == unit)
    if name not in laws:
        yield _unknown_law(name, kind, installed, laws, where)
    else:
        expected = f'one of the {kind} with unit "{unit}" ({names(installed) or "none"})'
        yield Fault(where, expected, f'"{name}" with unit "{laws[name].unit}"')


def _unknown_law(name: str, kind: str, installed: Sequence[str], laws: Laws, where: str) -> Fault:
    """Of laws that are combined, the one that is misspelt is told."""
    parts = SIGN.split(name)
    misspelt = [part for part in parts if part not in laws]
    claims = [f"{shown(part)}{claim}" for part in misspelt if (claim := claimed_twice(part, laws))]
    if claims:
        return Fault(where, f"one of the installed {kind}", claims[0])
    if len(parts) == 1 or misspelt:
        return choice_fault(where, f"installed {kind}", misspelt[0], laws if len(parts) > 1 else installed)
    return Fault(where, f"{kind} that can be combined like this, of the installed {kind} ({names(installed)})", shown(name))


def _joint_parameter_faults(joint: Joint, laws: Laws, where: str) -> Iterator[Fault]:
    plugins = (joint.law, *joint.factors)
    specs = specs_of(joint.law, joint.factors, laws)
    declared = [spec.name for name in plugins if name in laws for spec in laws[name].parameters]
    shared = [name for name in specs if declared.count(name) > 1]
    if shared:
        yield Fault(f"{where}/factors", "a law and factors whose parameters have different names", f"{names(shared)} repeated")
    if all(name in laws for name in plugins):
        for name in joint.parameters:
            if name not in specs:
                yield choice_fault(f"{where}/parameters", "parameters", name, specs)
    for name, spec in specs.items():
        if name not in joint.parameters and spec.default is None:
            yield Fault(f"{where}/{name}", _value_of(spec), "none")
    for name, value in joint.parameters.items():
        yield from _value_faults(value, specs.get(name), f"{where}/{name}")
    for part in (part for name in plugins if name in laws for part in laws[name].parts or (laws[name],)):
        lists = {spec.name: joint.parameters.get(spec.name) for spec in part.parameters}
        lengths = {name: len(value) for name, value in lists.items() if isinstance(value, tuple)}
        if len(set(lengths.values())) > 1:
            found = ", ".join(f"{length} of {name}" for name, length in lengths.items())
            yield Fault(f"{where}/parameters", "lists of the same length", found)


def _value_of(spec: ParameterSpec) -> str:
    return f"a list of numbers in {spec.unit}" if spec.vector else f"a number in {spec.unit}"


def _value_faults(value: Parameter | tuple[Parameter, ...], spec: ParameterSpec | None, where: str) -> Iterator[Fault]:
    entries = value if isinstance(value, tuple) else (value,)
    if spec is not None and spec.vector != isinstance(value, tuple):
        yield Fault(where, _value_of(spec), "a number" if spec.vector else "a list")
    elif not entries:
        yield Fault(where, "a list of at least one number", "an empty list")
    if spec is not None and spec.increasing:
        for before, after in pairwise(entry.value for entry in entries):
            if not before < after:
                yield Fault(where, "strictly increasing numbers", f"{after} after {before}")
    for index, entry in enumerate(entries):
        yield from parameter_faults(entry, spec, f"{where}[{index}]" if isinstance(value, tuple) else where)
