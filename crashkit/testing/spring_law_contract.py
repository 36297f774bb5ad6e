"""The contract of spring laws: what a law declares, checked on its own function."""

import inspect
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from crashkit.mechanics import LawFunction
from crashkit.mechanics.laws.emit import emit
from crashkit.protocols import ParameterSpec, SpringLaw

Values = Mapping[str, float | Sequence[float]]
Force = Callable[[float, float, float], float]
Point = tuple[float, float, float]

STATE = ("d", "ddot", "d_max")
NO_MEMORY = 0.0
UNIT = re.compile(r"1|[A-Za-z]+(-?\d+)?( [A-Za-z]+(-?\d+)?)*")


class SpringLawContract:
    """Tests of a law or factor; subclass it and give the fixtures `law` and `parameters`.

    Attributes:
        largest_deformation: m, how far the tests deform the joint.
        largest_rate: m s-1, how fast.
        preload: whether the law pushes before it is deformed.
    """

    largest_deformation = 1.0
    largest_rate = 20.0
    preload = False

    @pytest.fixture
    def law(self) -> type[SpringLaw]:
        """The class under test."""
        pytest.fail("a spring law's contract needs a fixture `law` that returns the class")

    @pytest.fixture
    def parameters(self) -> Values:
        """Values by name, for the tests to use; what is left out takes its default."""
        return {}

    @pytest.fixture
    def force(self, law: type[SpringLaw], parameters: Values) -> Force:
        """The law at these parameters, a function of d, ddot, d_max."""
        values = [_value(spec, parameters) for spec in law.parameters]
        return lambda d, ddot, d_max: float(law.force(d, ddot, d_max, *values))

    @pytest.fixture
    def derived(self, law: type[SpringLaw], parameters: Values) -> "Derived":
        """What the engine makes of the law's source, before it is compiled."""
        return Derived(law, parameters)

    def test_the_function_takes_the_state_and_the_declared_parameters(self, law: type[SpringLaw]) -> None:
        found = tuple(inspect.signature(law.force).parameters)
        expected = (*STATE, *(spec.name for spec in law.parameters))
        assert found == expected, f"the arguments of force: expected {', '.join(expected)}, found {', '.join(found)}"

    def test_names_and_units_are_those_of_the_data_contract(self, law: type[SpringLaw]) -> None:
        assert law.unit in ("N", "1"), f'the unit of {law.name}: expected "N" (a law) or "1" (a factor), found "{law.unit}"'
        for spec in law.parameters:
            assert spec.name.isidentifier(), f"the name of a parameter: expected an identifier, found {spec.name!r}"
            assert UNIT.fullmatch(spec.unit), (
                f'the unit of {spec.name}: expected a CF unit such as "N m-1", found "{spec.unit}"'
            )
            assert spec.meaning, f"the meaning of {spec.name}: expected a phrase, found none"

    def test_defaults_lie_within_bounds_or_take_the_physics_away(self, law: type[SpringLaw]) -> None:
        for spec in law.parameters:
            assert spec.lower < spec.upper, (
                f"the bounds of {spec.name}: expected lower < upper, found {spec.lower}, {spec.upper}"
            )
            if spec.default is not None and spec.default != spec.null:
                inside = spec.lower <= spec.default <= spec.upper
                assert inside, f"the default of {spec.name}: expected within its bounds or its null, found {spec.default}"

    def test_the_tested_values_lie_within_bounds(self, law: type[SpringLaw], parameters: Values) -> None:
        specs = {spec.name: spec for spec in law.parameters}
        for name, value in parameters.items():
            assert name in specs, f"the fixture parameters: {law.name} declares no {name}"
            spec = specs[name]
            inside = all(spec.lower <= entry <= spec.upper or entry == spec.null for entry in np.atleast_1d(value))
            assert inside, f"the value of {name}: expected within {spec.lower} to {spec.upper}, found {value}"

    def test_the_value_is_finite(self, law: type[SpringLaw], force: Force) -> None:
        for point in self._points():
            assert np.isfinite(force(*point)), f"{law.name} at {_where(point)}: expected a finite value, found {force(*point)}"

    def test_the_value_is_continuous(self, law: type[SpringLaw], force: Force) -> None:
        points = list(self._points())
        scale = max(abs(force(*point)) for point in points)
        for start, end in zip(points, points[1:], strict=False):
            jump, where = _largest_jump(force, start, end)
            assert jump <= 1e-6 * scale, f"{law.name} jumps by {jump:g} at {_where(where)}: expected a continuous value"

    def test_no_deformation_no_force(self, law: type[SpringLaw], force: Force) -> None:
        if law.unit == "N" and not self.preload:
            found = force(0.0, 0.0, 0.0)
            assert found == 0.0, f"{law.name} undeformed and at rest: expected no force (or preload = True), found {found:g} N"

    def test_a_passive_law_gives_out_no_more_energy_than_it_took_in(self, law: type[SpringLaw], force: Force) -> None:
        if law.unit == "N" and law.passive:
            for seed in range(20):
                stored, taken = self._energy(force, seed)
                assert stored >= -1e-3 * taken, (
                    f"{law.name} gave out {-stored:g} J more than it took in, of {taken:g} J: expected a passive law "
                    "(or passive = False)"
                )

    def test_a_factor_is_one_where_its_physics_is_absent(self, law: type[SpringLaw], parameters: Values) -> None:
        if law.unit == "1":
            null = {spec.name: spec.null for spec in law.parameters if spec.null is not None}
            assert null, f"{law.name} is a factor: expected a parameter with a null, at which it is 1"
            values = [_value(spec, {**parameters, **null}) for spec in law.parameters]
            for point in self._points():
                found = law.force(*point, *values)
                assert found == pytest.approx(1.0), f"{law.name} at its null and {_where(point)}: expected 1, found {found:g}"

    def test_a_factor_never_turns_a_force_round(self, law: type[SpringLaw], force: Force) -> None:
        if law.unit == "1":
            for point in self._points():
                assert force(*point) >= 0.0, f"{law.name} at {_where(point)}: expected 0 or more, found {force(*point):g}"

    def test_the_engine_reads_the_function_right(self, derived: "Derived", force: Force) -> None:
        for point in self._points():
            found, expected = derived.value(point), force(*point)
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-12), (
                f"at {_where(point)}: expected {expected}, found {found}"
            )

    def test_the_engine_derives_the_function_right(self, law: type[SpringLaw], derived: "Derived") -> None:
        for point in self._points():
            for name, found, expected, error in derived.slopes(point):
                assert abs(found - expected) <= error, (
                    f"the derivative of {law.name} to {name} at {_where(point)}: expected {expected:g}, found {found:g}"
                )

    def _points(self, count: int = 200) -> Iterator[Point]:
        """States that a joint can be in: half of them being loaded further than ever before."""
        random = np.random.default_rng(0)
        for index in range(count):
            d = random.uniform(-0.2, 1.0) * self.largest_deformation
            ddot = random.uniform(-1.0, 1.0) * self.largest_rate
            more = random.uniform(0.0, 0.5) * self.largest_deformation if index % 2 else 0.0
            yield d, ddot, max(d, 0.0) + more

    def _energy(self, force: Force, seed: int, count: int = 4000) -> tuple[float, float]:
        """J, the least that the law holds along a random path from rest and no deformation, and the most."""
        random = np.random.default_rng(seed)
        phase = np.linspace(0.0, 2.0 * np.pi, count)
        waves = sum(random.normal() * np.sin(n * phase) / n for n in range(1, 6))
        path = waves / np.abs(waves).max() * self.largest_deformation
        rate = np.gradient(path, phase)
        rate *= self.largest_rate / np.abs(rate).max()
        largest = np.maximum.accumulate(np.maximum(path, 0.0))
        forces = np.array([force(*map(float, state)) for state in zip(path, rate, largest, strict=True)])
        held = np.cumsum(0.5 * (forces[1:] + forces[:-1]) * np.diff(path))
        return float(held.min()), float(np.abs(held).max())


def _value(spec: ParameterSpec, parameters: Values) -> float | Sequence[float]:
    value = parameters.get(spec.name, spec.default)
    if value is None:
        pytest.fail(f"the fixture parameters: expected a value for {spec.name}, which has no default")
    return value


class Derived:
    """The functions that the engine writes for a law, run as plain Python."""

    def __init__(self, law: type[SpringLaw], parameters: Values) -> None:
        values = {spec.name: np.atleast_1d(_value(spec, parameters)).astype(float) for spec in law.parameters}
        sizes = tuple(values[spec.name].size for spec in law.parameters if spec.vector)
        self.vector = np.concatenate([*values.values(), np.empty(0)])
        self.names = [*STATE, *(spec.name for spec in law.parameters for _ in values[spec.name])]
        self.movable = [True] * len(STATE) + [
            spec.free and value not in (0.0, spec.null) for spec in law.parameters for value in values[spec.name]
        ]
        self.written: dict[str, Any] = {"math": math, "compiled": lambda function: function, "power_slope": _power_slope}
        exec(emit(LawFunction(law, sizes), "law"), self.written)

    def value(self, point: Point) -> float:
        """The value with the branches that the state takes."""
        return float(self.written["law_frozen"](self._mode(point, self.vector), *point, NO_MEMORY, self.vector, 0)[0])

    def slopes(self, point: Point) -> Iterator[tuple[str, float, float, float]]:
        """By name: the derivative, the central difference and its error; without those for which the branch changes."""
        inputs = np.array([*point, *self.vector])
        found = np.empty(inputs.size + 1)
        mode = self._mode(point, self.vector)
        self.written["law_partials"](mode, *point, NO_MEMORY, self.vector, 0, found)
        found = np.delete(found, len(STATE))
        for index in np.flatnonzero(self.movable):
            step = 1e-5 * (abs(inputs[index]) or 1.0)
            moved = [inputs + sign * step * (np.arange(inputs.size) == index) for sign in (1.0, -1.0)]
            if all(self._mode(near[:3], near[3:]) == mode for near in moved):
                above, below = (float(self.written["law_frozen"](mode, *near[:3], NO_MEMORY, near[3:], 0)[0]) for near in moved)
                expected = (above - below) / (2.0 * step)
                error = 1e-5 * max(abs(expected), abs(found[index])) + 1e-9 * (abs(above) + abs(below)) / step + 1e-12
                yield self.names[index], float(found[index]), expected, error

    def _mode(self, state: Iterable[float], vector: np.ndarray) -> int:
        return int(self.written["law_mode"](*state, NO_MEMORY, vector, 0))


def _power_slope(base: float, exponent: float) -> float:
    return base**exponent * math.log(base) if base > 0.0 else 0.0


def _where(point: Point) -> str:
    return "d = {:g} m, ddot = {:g} m/s, d_max = {:g} m".format(*point)


def _largest_jump(force: Force, start: Point, end: Point, count: int = 64) -> tuple[float, Point]:
    """The change of force left where the steepest part of the way between two states is halved down to nothing."""

    def at(share: float) -> Point:
        return tuple((1.0 - share) * a + share * b for a, b in zip(start, end, strict=True))  # type: ignore[return-value]

    shares = np.linspace(0.0, 1.0, count)
    forces = np.array([force(*at(share)) for share in shares])
    steepest = int(np.argmax(np.abs(np.diff(forces))))
    low, high = shares[steepest], shares[steepest + 1]
    for _ in range(50):
        middle = 0.5 * (low + high)
        before, after = (abs(force(*at(middle)) - force(*at(edge))) for edge in (low, high))
        low, high = (low, middle) if before > after else (middle, high)
    return abs(force(*at(high)) - force(*at(low))), at(middle)
