"""What a model must fulfil before it can be simulated, whether it came from a file or from a program."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

import xarray as xr

from crashkit.data.recording import instruments
from crashkit.data.validate import is_text, names, shown
from crashkit.errors import ContractError, Fault
from crashkit.model.body import Body
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.parameter import Parameter
from crashkit.protocols import Observer, ParameterSpec, SpringLaw

AXES = ("x", "y", "z")


def check_model(
    model: Model, laws: Mapping[str, type[SpringLaw]], source: str, observers: Mapping[str, type[Observer]] | None = None
) -> None:
    """Refuse a model that cannot be simulated: raises ContractError with every fault.

    Arguments:
        model: to be checked.
        laws: the installed laws and factors by name.
        source: the file or caller that the error names.
        observers: the installed observers by name; if given, instrument errors must be declared by one of them.
    """
    faults = model_faults(model, laws, observers)
    if faults:
        raise ContractError(source, faults)


def model_faults(
    model: Model, laws: Mapping[str, type[SpringLaw]], observers: Mapping[str, type[Observer]] | None = None
) -> list[Fault]:
    """Every fault of a model; see `check_model`."""
    return list(_model_faults(model, laws, observers))


def check_recording_against_model(tree: xr.DataTree, model: Model, source: str) -> None:
    """Refuse a recording whose bodies or axes are not those of the model: raises ContractError with every fault.

    Every text variable `<channel>_body` of an instrument must name bodies of the model. The group `initial` may hold bodies
    that the model does not have, but not while bodies of the model are missing from it: such a name is misspelt.
    """
    faults = list(_recording_faults(tree, model))
    if faults:
        raise ContractError(source, faults)


def place(kind: str, index: int, name: str) -> str:
    """How faults name a part of a model: joint "front", or joint[0] where it has no name."""
    return f"{kind} {shown(name)}" if name else f"{kind}[{index}]"


def instrument_place(instrument: str, sensor: str) -> str:
    """How faults name an instrument, or one of its sensors."""
    return f"instrument {shown(instrument)}" + (f" sensor {shown(sensor)}" if sensor else "")


def specs_of(law: str, factors: Iterable[str], laws: Mapping[str, type[SpringLaw]]) -> dict[str, ParameterSpec]:
    """The parameters that a law and its factors declare, by name, in their order; what is not installed declares none."""
    installed = [laws[name] for name in (law, *factors) if name in laws]
    return {spec.name: spec for plugin in installed for spec in plugin.parameters}


def _model_faults(
    model: Model, laws: Mapping[str, type[SpringLaw]], observers: Mapping[str, type[Observer]] | None
) -> Iterator[Fault]:
    if len(model.axes) != 1 or model.axes[0] not in AXES:
        yield Fault("axes", f"exactly one of {names(AXES)} (this version simulates one axis)", names(model.axes) or "none")
    yield from _name_faults("body", [body.name for body in model.bodies])
    yield from _name_faults("joint", [joint.name for joint in model.joints])
    yield from _repeated("instrument", [instrument_place(entry.instrument, entry.sensor) for entry in model.instruments])
    if all(body.fixed for body in model.bodies):
        yield Fault("body", "at least one body that is not fixed", "none")
    for index, body in enumerate(model.bodies):
        yield from _body_faults(body, model, place("body", index, body.name))
    for index, joint in enumerate(model.joints):
        yield from _joint_faults(joint, model, laws, place("joint", index, joint.name))
    for errors in model.instruments:
        yield from _instrument_faults(errors, observers)


def _name_faults(kind: str, found: Sequence[str]) -> Iterator[Fault]:
    for index, name in enumerate(found):
        if not name:
            yield Fault(f"{kind}[{index}]/name", "a name", "none")
    yield from _repeated(kind, [shown(name) for name in found if name])


def _repeated(kind: str, found: Sequence[str]) -> Iterator[Fault]:
    for name in dict.fromkeys(found):
        if found.count(name) > 1:
            yield Fault(kind, "names without repeats", f"{name} {found.count(name)} times")


def _body_faults(body: Body, model: Model, where: str) -> Iterator[Fault]:
    yield from _vector_faults(body.position, len(model.axes), f"{where}/position")
    yield from _vector_faults(body.velocity, len(model.axes), f"{where}/velocity")
    others = [other.name for other in model.bodies if other.name not in ("", body.name)]
    if body.carrier and body.carrier not in others:
        yield Fault(f"{where}/carrier", f"one of {names(others) or 'no bodies'}", shown(body.carrier))
    if body.fixed and any(body.velocity):
        yield Fault(f"{where}/velocity", "no velocity for a fixed body", names(body.velocity))
    if body.mass is None:
        if not body.fixed:
            yield Fault(f"{where}/mass", "a mass in kg", "none")
        return
    yield from _parameter_faults(body.mass, None, f"{where}/mass")
    if body.mass.value <= 0:
        yield Fault(f"{where}/mass", "a mass above 0", str(body.mass.value))
    elif not body.mass.fixed and body.mass.lower < 0:
        yield Fault(f"{where}/mass", "a lower bound of at least 0", str(body.mass.lower))


def _vector_faults(values: Sequence[float], axes: int, where: str) -> Iterator[Fault]:
    if len(values) != axes:
        yield Fault(where, f"one number for each of {axes} axes", f"{len(values)} numbers")
    for value in values:
        if not math.isfinite(value):
            yield Fault(where, "finite numbers", str(value))


def _joint_faults(joint: Joint, model: Model, laws: Mapping[str, type[SpringLaw]], where: str) -> Iterator[Fault]:
    known = [body.name for body in model.bodies if body.name]
    for name in joint.bodies:
        if name not in known:
            yield Fault(f"{where}/bodies", f"one of {names(known)}", shown(name))
    if joint.bodies[0] == joint.bodies[1]:
        yield Fault(f"{where}/bodies", "two different bodies", f"{shown(joint.bodies[0])} twice")
    for point in joint.points or ():
        yield from _vector_faults(point, len(model.axes), f"{where}/points")
    if joint.free_length is not None:
        yield from _parameter_faults(joint.free_length, None, f"{where}/free_length")
    yield from _law_faults(joint.law, "N", laws, f"{where}/law")
    for factor in joint.factors:
        yield from _law_faults(factor, "1", laws, f"{where}/factors")
    yield from _joint_parameter_faults(joint, laws, where)


def _law_faults(name: str, unit: str, laws: Mapping[str, type[SpringLaw]], where: str) -> Iterator[Fault]:
    kind = "laws" if unit == "N" else "factors"
    installed = names(sorted(law for law, plugin in laws.items() if plugin.unit == unit)) or "none"
    if name not in laws:
        yield Fault(where, f"one of the installed {kind} ({installed})", shown(name))
    elif laws[name].unit != unit:
        yield Fault(where, f'one of the {kind} with unit "{unit}" ({installed})', f'"{name}" with unit "{laws[name].unit}"')


def _joint_parameter_faults(joint: Joint, laws: Mapping[str, type[SpringLaw]], where: str) -> Iterator[Fault]:
    plugins = (joint.law, *joint.factors)
    specs = specs_of(joint.law, joint.factors, laws)
    declared = [spec.name for name in plugins if name in laws for spec in laws[name].parameters]
    shared = [name for name in specs if declared.count(name) > 1]
    if shared:
        yield Fault(f"{where}/factors", "a law and factors whose parameters have different names", f"{names(shared)} repeated")
    if all(name in laws for name in plugins):
        for name in joint.parameters:
            if name not in specs:
                yield Fault(f"{where}/parameters", f"one of {names(specs)}", shown(name))
    for name, spec in specs.items():
        if name not in joint.parameters and spec.default is None:
            yield Fault(f"{where}/{name}", _value_of(spec), "none")
    for name, value in joint.parameters.items():
        yield from _value_faults(value, specs.get(name), f"{where}/{name}")
    lengths = {name: len(value) for name, value in joint.parameters.items() if isinstance(value, tuple)}
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
        yield from _parameter_faults(entry, spec, f"{where}[{index}]" if isinstance(value, tuple) else where)


def _parameter_faults(parameter: Parameter, spec: ParameterSpec | None, where: str) -> Iterator[Fault]:
    value, lower, upper = parameter.value, parameter.lower, parameter.upper
    if (
        spec is not None and parameter.fixed and value in (spec.null, spec.default)
    ):  # absent physics may lie outside the bounds
        return
    slack = 1e-9 * abs(value)  # a value that was searched in its logarithm comes back from its bound with a rounding error
    if not math.isfinite(value):
        yield Fault(where, "a finite number", str(value))
    elif not lower <= upper:
        yield Fault(where, "a lower bound that does not exceed the upper", f"{lower} and {upper}")
    elif not lower - slack <= value <= upper + slack:
        yield Fault(where, f"a value {_interval(lower, upper)}", str(value))


def _interval(lower: float, upper: float) -> str:
    if lower == -math.inf:
        return f"of at most {upper}"
    return f"of at least {lower}" if upper == math.inf else f"from {lower} to {upper}"


def _instrument_faults(errors: InstrumentErrors, observers: Mapping[str, type[Observer]] | None) -> Iterator[Fault]:
    where = instrument_place(errors.instrument, errors.sensor)
    known = sorted({spec.name for observer in (observers or {}).values() for spec in observer.errors})
    for name, parameter in errors.parameters.items():
        if known and name not in known:
            yield Fault(f"{where}/parameters", f"one of {names(known)}", shown(name))
        yield from _parameter_faults(parameter, None, f"{where}/{name}")


def _recording_faults(tree: xr.DataTree, model: Model) -> Iterator[Fault]:
    bodies = [body.name for body in model.bodies]
    if "initial" in tree.children:
        yield from _initial_faults(tree["initial"].to_dataset(), model)
    for group in instruments(tree):
        for name, variable in tree[group].to_dataset().variables.items():
            if str(name).endswith("_body") and is_text(variable.values):
                unknown = [label for label in dict.fromkeys(variable.values.ravel().tolist()) if label not in bodies]
                if unknown:
                    yield Fault(f"{group}/{name}", f"bodies of the model ({names(bodies)})", names(unknown))


def _initial_faults(initial: xr.Dataset, model: Model) -> Iterator[Fault]:
    found = initial["body"].values.tolist()
    missing = [body.name for body in model.bodies if not body.fixed and body.name not in found]
    unknown = [name for name in found if name not in [body.name for body in model.bodies]]
    if missing and unknown:
        yield Fault("initial/body", f"the model's {names(missing)}", names(unknown))
    axes = [axis for axis in model.axes if axis not in initial["axis"].values.tolist()]
    if axes:
        yield Fault("initial/axis", f"the model's {names(axes)}", names(initial["axis"].values.tolist()))
