"""The units of a model's parameters."""

from collections.abc import Iterable

from crashkit.misfit.channel import Group
from crashkit.model import Model
from crashkit.protocols import Laws


def units_of(model: Model, laws: Laws, groups: Iterable[Group]) -> dict[str, str]:
    """The unit of every parameter, by path; "" for an error of an instrument that is none of the groups."""
    units = {f"body.{body.name}.mass": "kg" for body in model.bodies}
    units |= {f"body.{body.name}.inertia": "kg m2" for body in model.bodies}
    units |= {f"joint.{joint.name}.free_length": "m" for joint in model.joints}
    for joint in model.joints:
        for name in (joint.law, *joint.factors):
            units |= {f"joint.{joint.name}.{spec.name}": spec.unit for spec in laws[name].parameters}
    errors = {(group.name, spec.name): spec.unit for group in groups for spec in group.observer.errors}
    for entry in model.instruments:
        prefix = f"instrument.{entry.instrument}.{entry.sensor}."
        units |= {prefix + name: errors.get((entry.instrument, name), "") for name in entry.parameters}
    return {path: units.get(path.split("[")[0], "") for path in model.parameters()}
