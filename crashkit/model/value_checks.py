"""Whether numbers may take the place of a model's: what its file may not hold is refused."""

import re
from collections.abc import Collection, Iterator, Mapping

from attrs import evolve

from crashkit.data.validate import shown
from crashkit.errors import ContractError, CrashkitError, Fault, did_you_mean
from crashkit.model.number_checks import parameter_faults
from crashkit.model.parameter import Parameter

_POSITIVE = re.compile(r"body\..*\.(mass|inertia(\[[012]\])?)")
_STATE = re.compile(r"(body\..*\.(position|velocity|rotation|angular_velocity)|joint\..*\.points)(\[\d\])*")
"""Paths that a simulation takes, of numbers that are no parameters."""
STATE = " (states at t = 0 and points are given to the run: Simulator.run(times, values={...}))"


def check_values(
    values: Mapping[str, float],
    known: Mapping[str, Parameter],
    source: str,
    absent: Mapping[str, Collection[float | None]] | None = None,
) -> None:
    """Refuse values that a model file would refuse: raises ContractError with every fault.

    Arguments:
        values: SI units, by path; those of no known parameter are passed over.
        known: the parameters with their bounds, by path.
        source: what the error names.
        absent: values at which the physics is absent, which may lie outside the bounds, by path.
    """
    places = ((path, value) for path, value in values.items() if path in known)
    faults = [fault for path, value in places for fault in _faults(path, value, known[path], (absent or {}).get(path, ()))]
    if faults:
        raise ContractError(source, faults)


def check_paths(paths: Collection[str], known: Mapping[str, Parameter], source: str) -> None:
    """Refuse paths that are those of no parameter: raises CrashkitError, which names the first."""
    for path in sorted(set(paths) - known.keys()):
        hint = STATE if _STATE.fullmatch(path) else did_you_mean(path, known)
        raise CrashkitError(f"{source}: expected a parameter of the model, found {shown(path)}{hint}")


def _faults(path: str, value: float, parameter: Parameter, absent: Collection[float | None]) -> Iterator[Fault]:
    if value == parameter.value or value in absent:
        return
    try:
        changed = evolve(parameter, value=float(value))
    except (TypeError, ValueError):
        yield Fault(path, "a number", shown(value))
        return
    faults = list(parameter_faults(changed, None, path))
    if not faults and changed.value <= 0.0 and _POSITIVE.fullmatch(path):
        faults = [Fault(path, "a value above 0", str(value))]
    yield from faults
