"""What a model must fulfil before it can be simulated, whether it came from a file or from a program."""

from collections.abc import Iterator, Mapping, Sequence

from crashkit.data.validate import names, shown
from crashkit.errors import ContractError, Fault
from crashkit.model.body_checks import body_faults
from crashkit.model.choice import choice_fault
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint_checks import joint_faults, specs_of
from crashkit.model.model import Model
from crashkit.model.number_checks import parameter_faults, vector_faults
from crashkit.model.recording_checks import check_recording_against_model
from crashkit.protocols import Laws, Observer

__all__ = ["check_model", "check_recording_against_model", "instrument_place", "model_faults", "place", "specs_of"]

AXES = ("x", "y", "z")


def check_model(model: Model, laws: Laws, source: str, observers: Mapping[str, type[Observer]] | None = None) -> None:
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


def model_faults(model: Model, laws: Laws, observers: Mapping[str, type[Observer]] | None = None) -> list[Fault]:
    """Every fault of a model; see `check_model`."""
    return list(_model_faults(model, laws, observers))


def place(kind: str, index: int, name: str) -> str:
    """How faults name a part of a model: joint "front", or joint[0] where it has no name."""
    return f"{kind} {shown(name)}" if name else f"{kind}[{index}]"


def instrument_place(instrument: str, sensor: str) -> str:
    """How faults name an instrument, or one of its sensors."""
    return f"instrument {shown(instrument)}" + (f" sensor {shown(sensor)}" if sensor else "")


def _model_faults(model: Model, laws: Laws, observers: Mapping[str, type[Observer]] | None) -> Iterator[Fault]:
    if not model.axes or model.axes != tuple(axis for axis in AXES if axis in model.axes):
        yield Fault("axes", f"one, two or three of {names(AXES)}, in this order", names(model.axes) or "none")
    if model.gravity:
        yield from vector_faults(model.gravity, len(model.axes), "gravity")
    yield from _name_faults("body", [body.name for body in model.bodies])
    yield from _name_faults("joint", [joint.name for joint in model.joints])
    yield from _repeated("instrument", [instrument_place(entry.instrument, entry.sensor) for entry in model.instruments])
    if not any(body.is_free for body in model.bodies):
        yield Fault("body", "at least one body that forces move", "none")
    for index, body in enumerate(model.bodies):
        yield from body_faults(body, model, place("body", index, body.name))
    for index, joint in enumerate(model.joints):
        yield from joint_faults(joint, model, laws, place("joint", index, joint.name))
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


def _instrument_faults(errors: InstrumentErrors, observers: Mapping[str, type[Observer]] | None) -> Iterator[Fault]:
    where = instrument_place(errors.instrument, errors.sensor)
    known = sorted({spec.name for observer in (observers or {}).values() for spec in observer.errors})
    for name, parameter in errors.parameters.items():
        if known and name not in known:
            yield choice_fault(f"{where}/parameters", "errors that instruments have", name, known)
        yield from parameter_faults(parameter, None, f"{where}/{name}")
