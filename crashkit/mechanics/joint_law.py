"""The law of a joint with its factors along states that are known: its branches, its force and the derivatives of that."""

from collections.abc import Iterator, Mapping

import numpy as np
from attrs import frozen

from crashkit.errors import CrashkitError, SimulationError
from crashkit.mechanics.engine import Engine
from crashkit.mechanics.kernel.arrays import NONE, TO_D_MAX, TO_MEMORY, TO_PARAMETERS, Floats, Integers
from crashkit.mechanics.laws.source import LawFunction
from crashkit.mechanics.layout import functions_of_joint, memory_rate
from crashkit.model import Joint
from crashkit.protocols import Laws

Numbers = list[Floats]
"""The parameters of a law and of each of its factors."""


@frozen(eq=False)
class _Part:
    """The law or a factor: where its machine code is, the place of its parameters among those of the joint, and whether
    another joint drives it."""

    code: int
    memory_code: int
    place: Integers
    driven: bool


class JointLaw:
    """The force of a joint at any states (d, ddot, d_max), and its derivatives.

    Arguments:
        joint: of the model.
        laws: installed laws and factors by name.
        engine: that holds them.

    Attributes:
        paths: of the parameters that the law and its factors take, in order.
        memory: what they remember beside the state; "" for nothing.

    Raises:
        CrashkitError: a law is not installed, or runs as plain Python.
    """

    def __init__(self, joint: Joint, laws: Laws, engine: Engine) -> None:
        self.joint = joint
        functions = list(functions_of_joint(joint, laws))
        engine.check_derivatives(functions)
        own = [tuple(_paths(joint, function)) for function in functions]
        self.paths = tuple(dict.fromkeys(path for paths in own for path in paths))
        self.memory = " and ".join(function.law.memory for function in functions if function.law.memory)
        self._follow = engine.module.follow
        self._parts = [
            _Part(
                engine.codes[function],
                engine.codes[memory_rate(function)] if function.law.memory else int(NONE),
                np.array([self.paths.index(path) for path in paths], dtype=int),
                function.law.driven,
            )
            for function, paths in zip(functions, own, strict=True)
        ]
        specs = [spec for function in functions for spec in function.law.parameters]
        self._omitted = {f"joint.{joint.name}.{spec.name}": spec.default for spec in specs if spec.default is not None}

    def without_memory(self) -> "JointLaw":
        """Itself; raises CrashkitError where it remembers something."""
        if self.memory:
            raise CrashkitError(
                f"joint {self.joint.name}: expected a law without a memory of its own, "
                f"found {self.joint.law}, whose {self.memory} no state tells"
            )
        return self

    def numbers(self, values: Mapping[str, float]) -> Numbers:
        """The parameters of the law and of each factor, from values by path; what is omitted has the law's default."""
        known = [values[path] if path in values else self._omitted[path] for path in self.paths]
        return [np.array(known, dtype=float)[part.place] for part in self._parts]

    def modes(self, times: Floats, states: Floats, numbers: Numbers, drive: Floats | None = None) -> Integers:
        """The branches (function, time) that the law and its factors take along a motion that begins without memory.

        Arguments:
            times: (time,) s.
            states: (time, 3).
            numbers: see `numbers`.
            drive: (time, 3), states of the joint that drives it, if one does.
        """
        modes = np.zeros((len(self._parts), len(times)), dtype=np.int64)
        for part, own, taken in zip(self._parts, numbers, modes, strict=True):
            self._followed(part, times, _of(part, states, drive), own, taken, choose=True)
        return modes

    def forces(self, times: Floats, states: Floats, numbers: Numbers, drive: Floats | None = None) -> Floats:
        """The forces (time,), N, along a motion that begins without memory; arguments as of `modes`."""
        force, modes = np.ones(len(times)), np.zeros(len(times), dtype=np.int64)
        for part, own in zip(self._parts, numbers, strict=True):
            force *= self._followed(part, times, _of(part, states, drive), own, modes, choose=True)[0]
        return force

    def evaluate(
        self, times: Floats, states: Floats, modes: Integers, numbers: Numbers, drive: Floats | None = None
    ) -> tuple[Floats, Floats, Floats]:
        """The forces (time,), N, on given branches, and their derivatives.

        These are to d, ddot, d_max and each of `paths`, and apart from them those to d and ddot of what drives it.

        What a memory owes to the past counts as derivative to d, as if all deformations were shifted alike.
        """
        force, driven = np.ones(len(times)), np.zeros((len(times), 2))
        slopes = np.zeros((len(times), TO_MEMORY + len(self.paths)))
        for part, own, taken in zip(self._parts, numbers, modes, strict=True):
            value, changes = self._followed(part, times, _of(part, states, drive), own, taken, choose=False)
            slopes *= value[:, None]
            driven *= value[:, None]
            changes *= force[:, None]
            (driven if part.driven else slopes)[:, :2] += changes[:, :2]
            slopes[:, TO_D_MAX] += 0.0 if part.driven else changes[:, TO_D_MAX]
            slopes[:, TO_MEMORY + part.place] += changes[:, TO_PARAMETERS:]
            force *= value
        self._check(states, np.isfinite(force) & np.isfinite(slopes).all(axis=1))
        return force, slopes, driven

    def _followed(
        self, part: _Part, times: Floats, states: Floats, own: Floats, modes: Integers, choose: bool
    ) -> tuple[Floats, Floats]:
        """The value of one function, and its derivatives."""
        values, slopes = np.zeros(len(times)), np.zeros((len(times), TO_PARAMETERS + len(own)))
        changes = np.zeros((2, slopes.shape[1]))
        self._follow(part.code, part.memory_code, own, times, states, choose, modes, changes, values, slopes)
        return values, slopes

    def _check(self, states: Floats, finite: np.ndarray) -> None:
        if not finite.all():
            d, rate, _ = states[np.argmin(finite)]
            raise SimulationError(
                f"joint {self.joint.name}: expected a force, found none at d = {d:.6g} m, rate {rate:.6g} m/s"
            )


def _of(part: _Part, states: Floats, drive: Floats | None) -> Floats:
    """The states that a function takes."""
    if not part.driven:
        return states
    assert drive is not None  # as the model's checks say
    return drive


def _paths(joint: Joint, function: LawFunction) -> Iterator[str]:
    lengths = function.lengths()
    for spec in function.law.parameters:
        path = f"joint.{joint.name}.{spec.name}"
        yield from (f"{path}[{i}]" for i in range(lengths[spec.name])) if spec.vector else (path,)
