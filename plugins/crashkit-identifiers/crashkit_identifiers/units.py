"""The units of a problem's parameters."""

import numpy as np

from crashkit.misfit import Misfit
from crashkit.protocols import Problem
from crashkit_identifiers.recorded import laws_of


def units_of(problem: Problem) -> np.ndarray:
    """The unit of every parameter; "" where the problem does not know."""
    known = _by_path(problem) if isinstance(problem, Misfit) else {}
    return np.array([known.get(name.split("[")[0], "") for name in problem.names], dtype=str)


def _by_path(misfit: Misfit) -> dict[str, str]:
    model, laws = misfit.model, laws_of(misfit)
    units = {f"body.{body.name}.mass": "kg" for body in model.bodies}
    units |= {f"body.{body.name}.inertia": "kg m2" for body in model.bodies}
    units |= {f"joint.{joint.name}.free_length": "m" for joint in model.joints}
    for joint in model.joints:
        for name in (joint.law, *joint.factors):
            units |= {f"joint.{joint.name}.{spec.name}": spec.unit for spec in laws[name].parameters}
    specs = {(group.name, spec.name): spec.unit for group in misfit.groups for spec in group.observer.errors}
    for entry in model.instruments:
        prefix = f"instrument.{entry.instrument}.{entry.sensor}."
        units |= {prefix + name: specs.get((entry.instrument, name), "") for name in entry.parameters}
    return units
