"""The law of a joint with its factors as plain Python: the engine's branches and derivatives, one state at a time."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from crashkit.errors import CrashkitError
from crashkit.mechanics.laws.plain import plain
from crashkit.mechanics.laws.source import STATE, LawFunction
from crashkit.model import Joint
from crashkit.protocols import SpringLaw

Modes = tuple[int, ...]
"""The branches that a law and its factors take, one number each."""

NO_MEMORY = (0.0,)
"""What stands for the memory of a law that has none."""


class JointLaw:
    """The force of a joint at any state (d, ddot, d_max), and its derivatives.

    Arguments:
        joint: of the model.
        laws: installed laws and factors by name.

    Attributes:
        paths: of the parameters that the law and its factors take, in order.

    Raises:
        CrashkitError: a law is not installed, or has a memory of its own, which no state (d, ddot, d_max) tells.
    """

    def __init__(self, joint: Joint, laws: Mapping[str, type[SpringLaw]]) -> None:
        self.joint = joint
        functions = [_function(joint, laws, name) for name in (joint.law, *joint.factors)]
        own = [tuple(_paths(joint, function)) for function in functions]
        self.paths = tuple(dict.fromkeys(path for paths in own for path in paths))
        places = [np.array([self.paths.index(path) for path in paths], dtype=int) for paths in own]
        self._parts = [(plain(function), place) for function, place in zip(functions, places, strict=True)]
        specs = [spec for function in functions for spec in function.law.parameters]
        self._omitted = {f"joint.{joint.name}.{spec.name}": spec.default for spec in specs if spec.default is not None}

    def numbers(self, values: Mapping[str, float]) -> list[list[float]]:
        """The parameters of the law and of each factor, from values by path; what is omitted has the law's default."""
        known = {**self._omitted, **values}
        return [[known[self.paths[i]] for i in place] for _, place in self._parts]

    def modes(self, state: Sequence[float], numbers: Sequence[Sequence[float]]) -> Modes:
        """The branches that a state takes."""
        return tuple(law.mode(*state, *NO_MEMORY, own, 0) for (law, _), own in zip(self._parts, numbers, strict=True))

    def evaluate(self, state: Sequence[float], modes: Modes, numbers: Sequence[Sequence[float]]) -> tuple[float, np.ndarray]:
        """The force, N, on given branches, and its derivatives to d, ddot, d_max and each of `paths`."""
        force, slopes = 1.0, np.zeros(len(STATE) + len(self.paths))
        inputs = len(STATE) + len(NO_MEMORY)
        for (law, place), mode, own in zip(self._parts, modes, numbers, strict=True):
            out = np.zeros(inputs + len(own))
            try:
                value = law.partials(mode, *state, *NO_MEMORY, own, 0, out)
            except (ArithmeticError, ValueError) as error:
                found = f"none at d = {state[0]:.6g} m, rate {state[1]:.6g} m/s ({error})"
                raise CrashkitError(f"joint {self.joint.name}: expected a force, found {found}") from error
            slopes *= value
            slopes[: len(STATE)] += force * out[: len(STATE)]
            np.add.at(slopes, len(STATE) + place, force * out[inputs:])
            force *= value
        return force, slopes


def _function(joint: Joint, laws: Mapping[str, type[SpringLaw]], name: str) -> LawFunction:
    law = laws.get(name)
    if law is None:
        raise CrashkitError(f"joint {joint.name}: expected a law that is installed ({', '.join(sorted(laws))}), found {name}")
    if law.memory:
        raise CrashkitError(
            f"joint {joint.name}: expected a law without a memory of its own, found {name}, whose {law.memory} no motion tells"
        )
    vectors = [joint.parameters[spec.name] for spec in law.parameters if spec.vector]
    return LawFunction(law, tuple(len(entries) for entries in vectors if isinstance(entries, tuple)))


def _paths(joint: Joint, function: LawFunction) -> Iterator[str]:
    lengths = function.lengths()
    for spec in function.law.parameters:
        path = f"joint.{joint.name}.{spec.name}"
        yield from (f"{path}[{i}]" for i in range(lengths[spec.name])) if spec.vector else (path,)
