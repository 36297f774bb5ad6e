"""What an identification did not move, and why: a number at its law's null, for example, leaves physics out without a word."""

from collections.abc import Sequence
from itertools import groupby

from attrs import frozen

from crashkit.model import Model
from crashkit.protocols import Laws, ParameterSpec

NOTES = {"null": " (the law's null)", "default": " (the law's default)", "fixed": ""}


@frozen
class Held:
    """A number of a model that was held.

    Attributes:
        parameter: its path.
        value: SI units.
        why: "null", where the physics of its law is absent; "default", the law's own; "fixed" by the file.
    """

    parameter: str
    value: float
    why: str

    @property
    def owner(self) -> str:
        """The path of its body, joint or sensor."""
        return self.parameter.rpartition(".")[0]

    @property
    def name(self) -> str:
        """Within its owner; numbers of a vector have one name."""
        return self.parameter.rpartition(".")[2].partition("[")[0]


def held_in(model: Model, laws: Laws) -> list[Held]:
    """Every number of a model that is not free, in the order of its file."""
    specs = {
        f"joint.{joint.name}.{spec.name}": spec
        for joint in model.joints
        for law in (joint.law, *joint.factors)
        for spec in laws[law].parameters
    }
    fixed = {path: parameter.value for path, parameter in model.parameters().items() if parameter.fixed}
    return [Held(path, value, _why(specs.get(path), value)) for path, value in fixed.items()]


def told(held: Sequence[Held]) -> str:
    """The same for people: a line for all owners of the same numbers."""
    owners: dict[str, list[str]] = {}
    for owner, numbers in groupby(held, lambda one: one.owner):
        owners.setdefault(_numbers(list(numbers)), []).append(owner)
    return "\n".join(["held:", *(f"  {', '.join(names)}: {numbers}" for numbers, names in owners.items())])


def _why(spec: ParameterSpec | None, value: float) -> str:
    if spec is None or value not in (spec.null, spec.default):
        return "fixed"
    return "null" if value == spec.null else "default"


def _numbers(held: Sequence[Held]) -> str:
    """Those of one owner: "toe, damping at 0, tension_force at 1e+12 (the law's null); engagement at 0.001 (...)"."""
    alike = {why: _alike([one for one in held if one.why == why]) for why in NOTES}
    return "; ".join(f"{numbers}{NOTES[why]}" for why, numbers in alike.items() if numbers)


def _alike(held: Sequence[Held]) -> str:
    """Names that are held at the same value together; of a vector with several values, how many it has."""
    values: dict[str, list[float]] = {}
    for one in held:
        values.setdefault(one.name, []).append(one.value)
    names: dict[str, list[str]] = {}
    for name, own in values.items():
        names.setdefault(f"at {own[0]:.6g}" if len(set(own)) == 1 else f"at {len(own)} numbers", []).append(name)
    return ", ".join(f"{', '.join(same)} {where}" for where, same in names.items())
