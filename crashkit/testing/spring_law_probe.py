"""A spring law at given parameters: its functions, the states a joint can be in, and what the engine makes of it."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np
import pytest
from attrs import define, field
from scipy.integrate import solve_ivp

from crashkit.mechanics import LawFunction
from crashkit.mechanics.laws.plain import Plain, plain
from crashkit.mechanics.laws.source import state_of
from crashkit.protocols import ParameterSpec, SpringLaw

Values = Mapping[str, float | Sequence[float]]
Point = tuple[float, float, float, float]
"""Deformation, rate, largest deformation and memory (0 where there is none)."""
Function = Callable[[Point], float]

SEEDS = 20
TO_MEMORY = 3
"""Where the derivative to the memory stands, which is left out for a law without one."""


@define(slots=False)
class Probe:
    """A law at the parameters under test.

    Arguments:
        law: the class.
        parameters: by name; what is left out takes its default.
        reach: m and m s-1, how far and how fast the joint is deformed.
    """

    law: type[SpringLaw]
    parameters: Values
    reach: tuple[float, float] = field(default=(1.0, 20.0))

    @property
    def parts(self) -> tuple[str, ...]:
        """The functions of the law."""
        return ("force", "memory_rate") if self.law.memory else ("force",)

    def function(self, part: str, parameters: Values | None = None) -> Function:
        """A function of the law, of a point."""
        values = [value_of(spec, self.parameters if parameters is None else parameters) for spec in self.law.parameters]
        called, count = getattr(self.law, part), len(state_of(self.law))

        def value(point: Point) -> float:
            try:
                found = called(*point[:count], *values)
            except Exception as error:
                pytest.fail(self._at(part, point, f"{type(error).__name__}: {error}"), pytrace=False)
            if found is None:
                pytest.fail(self._at(part, point, "None: a way through it ends without a return"), pytrace=False)
            return float(found)

        return value

    def _at(self, part: str, point: Point, found: str) -> str:
        return f"{part} of {self.law.name} at {where(self.law, point)}: expected a number, found {found}"

    @cached_property
    def force(self) -> Function:
        """The force or factor."""
        return self.function("force")

    def points(self, count: int = 200) -> Iterator[Point]:
        """States that a joint can be in: half of them being loaded further than ever before."""
        random = np.random.default_rng(0)
        low, high = self.memories
        for index in range(count):
            d = random.uniform(-0.2, 1.0) * self.reach[0]
            ddot = random.uniform(-1.0, 1.0) * self.reach[1]
            more = random.uniform(0.0, 0.5) * self.reach[0] if index % 2 else 0.0
            yield d, ddot, max(d, 0.0) + more, float(random.uniform(low, high)) if self.law.memory else 0.0

    @cached_property
    def memories(self) -> tuple[float, float]:
        """The least and the greatest memory on some random paths."""
        found = np.concatenate([self.path(seed)[:, TO_MEMORY] for seed in range(3)]) if self.law.memory else np.zeros(1)
        return float(found.min()), float(found.max())

    def path(self, seed: int, count: int = 4000) -> np.ndarray:
        """The points (time, 4) of a random motion from rest and no deformation, with the time that each of them takes."""
        random = np.random.default_rng(seed)
        phase = np.linspace(0.0, 2.0 * np.pi, count)
        heights = random.normal(size=5) / np.arange(1.0, 6.0)
        d = np.sin(np.outer(phase, np.arange(1.0, 6.0))) @ heights
        heights *= self.reach[0] / np.abs(d).max()
        rate = np.cos(np.outer(phase, np.arange(1.0, 6.0))) @ (heights * np.arange(1.0, 6.0))
        speed = self.reach[1] / np.abs(rate).max()
        d *= self.reach[0] / np.abs(d).max()
        points = np.column_stack([d, speed * rate, np.maximum.accumulate(np.maximum(d, 0.0)), np.zeros(count)])
        if self.law.memory:
            points[:, TO_MEMORY] = self._remembered(phase / speed, points)
        return points

    def _remembered(self, times: np.ndarray, points: np.ndarray) -> np.ndarray:
        """The memory along a path, whose times are even."""
        rate, states, step = self.function("memory_rate"), points[:, :TO_MEMORY].tolist(), times[1]

        def slope(t: float, memory: np.ndarray) -> float:
            before = min(int(t / step), len(states) - 2)
            share = t / step - before
            d, ddot, d_max = (a + share * (b - a) for a, b in zip(states[before], states[before + 1], strict=True))
            return rate((d, ddot, d_max, float(memory[0])))

        solved = solve_ivp(slope, (times[0], times[-1]), [0.0], "LSODA", times, max_step=times[-1] / 200, rtol=1e-5, atol=1e-9)
        return solved.y[0]

    def energy(self, seed: int) -> tuple[float, float]:
        """J, the least that the law holds along a random path, and the most."""
        points = self.path(seed)
        forces = np.array([self.force((d, ddot, d_max, z)) for d, ddot, d_max, z in points.tolist()])
        held = np.cumsum(0.5 * (forces[1:] + forces[:-1]) * np.diff(points[:, 0]))
        return float(held.min()), float(np.abs(held).max())

    def derived(self, part: str) -> "Derived":
        """What the engine makes of a function of the law."""
        return Derived(self, part)


class Derived:
    """The functions that the engine writes for a function of a law, run as plain Python.

    Raises:
        CrashkitError: it writes none, because the law cannot be read.
    """

    def __init__(self, probe: Probe, part: str) -> None:
        law = probe.law
        values = {spec.name: np.atleast_1d(value_of(spec, probe.parameters)).astype(float) for spec in law.parameters}
        self.function = LawFunction(law, tuple(values[spec.name].size for spec in law.parameters if spec.vector), part)
        self.vector = np.concatenate([*values.values(), np.empty(0)])
        self.names = [*state_of(law), *(spec.name for spec in law.parameters for _ in values[spec.name])]
        self.has_memory = bool(law.memory)
        self.movable = [True] * len(state_of(law)) + [
            spec.free and value not in (0.0, spec.null) for spec in law.parameters for value in values[spec.name]
        ]
        self.plain: Plain = plain(self.function)

    def mode(self, point: Point) -> int:
        """The branches that a point takes."""
        return self._mode(point, self.vector)

    def value(self, point: Point, mode: int | None = None) -> tuple[float, float]:
        """Value and smallest guard on given branches; None: on those that the point takes."""
        return self._value(self.mode(point) if mode is None else mode, point, self.vector)

    def slopes(self, point: Point) -> Iterator[tuple[str, float, float, float]]:
        """By name: the derivative, the central difference and its error; without those for which the branch changes."""
        inputs, mode = np.array([*point, *self.vector]), self.mode(point)
        found = np.empty(inputs.size)
        self.plain.partials(mode, *point, self.vector, 0, found)
        kept = np.array([i for i in range(inputs.size) if i != TO_MEMORY or self.has_memory])
        for name, index in zip(self.names, kept, strict=True):
            if not self.movable[self._place(index)]:
                continue
            step = 1e-5 * (abs(inputs[index]) or 1.0)
            moved = [inputs + sign * step * (np.arange(inputs.size) == index) for sign in (1.0, -1.0)]
            if all(self._mode(near[:4], near[4:]) == mode for near in moved):
                above, below = (self._value(mode, near[:4], near[4:])[0] for near in moved)
                expected = (above - below) / (2.0 * step)
                error = 1e-5 * max(abs(expected), abs(found[index])) + 1e-9 * (abs(above) + abs(below)) / step + 1e-12
                yield name, float(found[index]), expected, error

    def _place(self, index: int) -> int:
        return index if self.has_memory or index < TO_MEMORY else index - 1

    def _mode(self, point: Iterable[float], vector: np.ndarray) -> int:
        return int(self.plain.mode(*point, vector, 0))

    def _value(self, mode: int, point: Iterable[float], vector: np.ndarray) -> tuple[float, float]:
        value, guard = self.plain.frozen(mode, *point, vector, 0)
        return float(value), float(guard)


def value_of(spec: ParameterSpec, parameters: Values) -> float | Sequence[float]:
    """The value of a parameter under test."""
    value = parameters.get(spec.name, spec.default)
    if value is None:
        pytest.fail(f"the fixture parameters: expected a value for {spec.name}, which has no default")
    return value


def where(law: type[SpringLaw], point: Point) -> str:
    """A state in words."""
    memory = f", {law.memory} = {point[3]:g}" if law.memory else ""
    return f"d = {point[0]:g} m, ddot = {point[1]:g} m/s, d_max = {point[2]:g} m{memory}"


def between(start: Point, end: Point, share: float) -> Point:
    """A state on the straight way between two."""
    return tuple((1.0 - share) * a + share * b for a, b in zip(start, end, strict=True))  # type: ignore[return-value]


def largest_jump(function: Function, start: Point, end: Point, count: int = 64) -> tuple[float, Point]:
    """The change that is left where the steepest part of the way between two states is halved down to nothing."""
    shares = np.linspace(0.0, 1.0, count)
    values = np.array([function(between(start, end, share)) for share in shares])
    steepest = int(np.argmax(np.abs(np.diff(values))))
    low, high = float(shares[steepest]), float(shares[steepest + 1])
    for _ in range(50):
        middle = 0.5 * (low + high)
        at = function(between(start, end, middle))
        before, after = (abs(at - function(between(start, end, edge))) for edge in (low, high))
        low, high = (low, middle) if before > after else (middle, high)
    return function(between(start, end, high)) - function(between(start, end, low)), between(start, end, middle)


def branch_end(derived: Derived, start: Point, end: Point) -> tuple[Point, Point]:
    """The two sides of a place between two states of different branches where that of the first ends."""
    mode, low, high = derived.mode(start), 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if derived.mode(between(start, end, middle)) == mode else (low, middle)
    return between(start, end, low), between(start, end, high)
