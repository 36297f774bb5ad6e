"""Small changes to a model, each returning a new one: what hypotheses are made of."""

from collections.abc import Iterable, Mapping
from typing import Any

from attrs import evolve

from crashkit.model.body import Body
from crashkit.model.instrument import InstrumentErrors
from crashkit.model.joint import Joint
from crashkit.model.model import Model
from crashkit.model.parameter import Parameter


def with_joint(model: Model, joint: Joint) -> Model:
    """The model with one more joint; joints between the same two bodies add up."""
    return evolve(model, joints=(*model.joints, joint))


def without_joint(model: Model, joint: str) -> Model:
    """The model without one of its joints; raises CrashkitError for one it does not have."""
    removed = model.joint(joint)
    return evolve(model, joints=tuple(other for other in model.joints if other != removed))


def with_changed_joint(model: Model, joint: str, **changes: Any) -> Model:
    """The model with other values for some fields of one joint."""
    return evolve(model, joints=tuple(evolve(one, **changes) if one.name == joint else one for one in model.joints))


def with_body(model: Model, body: Body) -> Model:
    """The model with one more body."""
    return evolve(model, bodies=(*model.bodies, body))


def with_factor(model: Model, joint: str, factor: str, parameters: Mapping[str, Parameter | tuple[Parameter, ...]]) -> Model:
    """The model with a factor that multiplies the law of one joint; raises CrashkitError for one it does not have."""
    own = model.joint(joint)
    return with_changed_joint(model, joint, factors=(*own.factors, factor), parameters={**own.parameters, **parameters})


def with_instrument_error(model: Model, instrument: str, sensor: str, name: str, parameter: Parameter) -> Model:
    """The model with one error parameter of a sensor, or (`sensor` empty) of a whole instrument."""
    known = [e for e in model.instruments if (e.instrument, e.sensor) == (instrument, sensor)]
    others = tuple(e for e in model.instruments if e not in known)
    before = known[0].parameters if known else {}
    return evolve(model, instruments=(*others, InstrumentErrors(instrument, sensor, {**before, name: parameter})))


def fresh_name(wanted: str, taken: Iterable[str]) -> str:
    """`wanted`, or `wanted_2`, `wanted_3`, ... if that name is taken."""
    taken = set(taken)
    candidates = [wanted, *(f"{wanted}_{number}" for number in range(2, len(taken) + 3))]
    return next(name for name in candidates if name not in taken)
