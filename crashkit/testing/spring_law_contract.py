"""The contract of spring laws: what a law declares, checked on its own functions, and told in words."""

import inspect
import re

import numpy as np
import pytest

from crashkit.errors import CrashkitError
from crashkit.mechanics.laws.own_branches import compile_own, has_own_branches
from crashkit.mechanics.laws.source import OutsideSubset, state_of
from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.testing.spring_law_probe import SEEDS, Derived, Point, Probe, Values, branch_end, largest_jump, where

SYMBOLS = ("kg", "m", "s", "rad", "N", "J", "W", "Pa", "K")
"""Of SI units without prefixes: nothing is converted anywhere."""
UNIT = re.compile(r"1|{0}( {0})*".format(rf"({'|'.join(SYMBOLS)})(-?\d+)?"))
REST: Point = (0.0, 0.0, 0.0, 0.0)
SMALL = 1e-6
"""A jump that is none, relative to the largest value."""


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
    def probe(self, law: type[SpringLaw], parameters: Values) -> Probe:
        """The law at these parameters."""
        if problem := _undeclared(law):
            pytest.fail(problem, pytrace=False)
        return Probe(law, parameters, (self.largest_deformation, self.largest_rate))

    @pytest.fixture
    def derived(self, probe: Probe) -> list[Derived]:
        """What the engine makes of each of the law's functions, before it is compiled."""
        try:
            return [probe.derived(part) for part in probe.parts]
        except OutsideSubset as error:
            if probe.law.opaque:
                pytest.skip(f"{probe.law.name} is declared opaque: it runs slowly and gives no sensitivities")
            pytest.fail(
                f"{error}. Else give branch, branch_force and branch_slopes, or declare opaque = True: then the law runs as "
                "plain Python, slowly and without sensitivities",
                pytrace=False,
            )
        except CrashkitError as error:
            raise pytest.fail.Exception(str(error), pytrace=False) from None

    # declaration

    def test_the_class_declares_a_name_parameters_and_functions(self, law: type[SpringLaw]) -> None:
        problem = _undeclared(law)
        assert not problem, problem

    def test_the_functions_take_the_state_and_the_declared_parameters(self, law: type[SpringLaw]) -> None:
        assert isinstance(law, type), f"the fixture law: expected the class, found the instance {law!r}"
        expected = (*state_of(law), *(spec.name for spec in law.parameters))
        for part in ("force", "memory_rate") if law.memory else ("force",):
            missing = getattr(law, part) is getattr(SpringLaw, part, None)
            assert not missing, f"{law.name} has a memory, {law.memory}: expected memory_rate, found none"
            found = tuple(inspect.signature(getattr(law, part)).parameters)
            assert found == expected, f"the arguments of {part}: expected {', '.join(expected)}, found {', '.join(found)}"

    def test_names_and_units_are_those_of_the_data_contract(self, law: type[SpringLaw]) -> None:
        assert law.name.isidentifier(), (
            f'the name of {law.__name__}: expected an identifier, as a space or a sign combines laws, found "{law.name}"'
        )
        assert law.unit in ("N", "1"), f'the unit of {law.name}: expected "N" (a law) or "1" (a factor), found "{law.unit}"'
        assert law.memory == "" or law.memory.isidentifier(), (
            f"the memory of {law.name}: expected an identifier, found {law.memory!r}"
        )
        for spec in law.parameters:
            assert spec.name.isidentifier(), f"the name of a parameter: expected an identifier, found {spec.name!r}"
            assert UNIT.fullmatch(spec.unit), (
                f'the unit of {spec.name}: expected an SI unit of {", ".join(SYMBOLS)} such as "N m-1", found "{spec.unit}"'
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

    # behaviour

    def test_the_value_is_finite(self, law: type[SpringLaw], probe: Probe) -> None:
        for part in probe.parts:
            function = probe.function(part)
            for point in probe.points():
                assert np.isfinite(function(point)), (
                    f"{part} of {law.name} at {where(law, point)}: expected a finite value, found {function(point)}"
                )

    def test_the_value_is_continuous_or_declared_to_jump(self, law: type[SpringLaw], probe: Probe) -> None:
        points = list(probe.points())
        for part in () if law.jumps else probe.parts:
            function = probe.function(part)
            scale = max(abs(function(point)) for point in points)
            for start, end in zip(points, points[1:], strict=False):
                jump, place = largest_jump(function, start, end)
                assert abs(jump) <= SMALL * scale, (
                    f"{part} of {law.name} jumps by {abs(jump):g} at {where(law, place)}: "
                    "expected a continuous value (or jumps = True)"
                )

    def test_a_jump_does_not_hold_the_joint(self, law: type[SpringLaw], probe: Probe) -> None:
        """A force that rises by a jump with the rate brakes on one side and speeds up on the other: nothing gets past."""
        if law.jumps:
            scale = max(abs(probe.force(point)) for point in probe.points())
            for d, _, d_max, memory in probe.points(50):
                slow, fast = ((d, sign * self.largest_rate, d_max, memory) for sign in (-1.0, 1.0))
                jump, place = largest_jump(probe.force, slow, fast)
                assert jump <= SMALL * scale, (
                    f"{law.name} rises by a jump of {jump:g} with the rate at {where(law, place)}, which would hold the "
                    "joint there: expected a smooth rise, such as tanh(ddot / slip_rate)"
                )

    def test_no_deformation_no_force(self, law: type[SpringLaw], probe: Probe) -> None:
        if law.unit == "N" and not self.preload:
            found = probe.force(REST)
            assert found == 0.0, f"{law.name} undeformed and at rest: expected no force (or preload = True), found {found:g} N"

    def test_a_memory_rests_where_nothing_happens(self, law: type[SpringLaw], probe: Probe) -> None:
        if law.memory and not self.preload:
            found = probe.function("memory_rate")(REST)
            assert found == 0.0, (
                f"the memory of {law.name}, undeformed, at rest and at 0: expected a rate of 0 (or preload = True), "
                f"found {found:g}"
            )

    def test_a_passive_law_gives_out_no_more_energy_than_it_took_in(self, law: type[SpringLaw], probe: Probe) -> None:
        if law.unit == "N" and law.passive:
            for seed in range(SEEDS):
                stored, taken = probe.energy(seed)
                assert stored >= -1e-3 * taken, (
                    f"{law.name} gave out {-stored:g} J more than it took in, of {taken:g} J: expected a passive law "
                    "(or passive = False)"
                )

    def test_a_factor_is_one_where_its_physics_is_absent(self, law: type[SpringLaw], probe: Probe) -> None:
        if law.unit == "1":
            nulls = {spec.name: spec.null for spec in law.parameters if spec.null is not None}
            null = {name: _like(probe.parameters.get(name), value) for name, value in nulls.items()}
            assert null, f"{law.name} is a factor: expected a parameter with a null, at which it is 1"
            function = probe.function("force", {**probe.parameters, **null})
            for point in probe.points():
                found = function(point)
                assert found == pytest.approx(1.0), (
                    f"{law.name} at its null and {where(law, point)}: expected 1, found {found:g}"
                )

    def test_a_driven_law_is_one_smooth_piece(self, law: type[SpringLaw], probe: Probe, derived: list[Derived]) -> None:
        """What the engine knows of the joint that drives it is where that is, and not which branches it takes there."""
        for one in derived if law.driven else []:
            for point in probe.points():
                assert np.isinf(one.value(point)[1]) and not law.memory, (
                    f"{law.name} is driven: expected one smooth piece, without branches, min, max, abs and memory, "
                    f"found the end of a branch near {where(law, point)}"
                )

    def test_a_factor_never_turns_a_force_round(self, law: type[SpringLaw], probe: Probe) -> None:
        if law.unit == "1":
            for point in probe.points():
                found = probe.force(point)
                assert found >= 0.0, f"{law.name} at {where(law, point)}: expected 0 or more, found {found:g}"

    # what the engine makes of it

    def test_the_engine_reads_the_functions_right(self, law: type[SpringLaw], probe: Probe, derived: list[Derived]) -> None:
        for one in derived:
            function, part = probe.function(one.function.part), one.function.part
            for point in probe.points():
                (found, guard), expected = one.value(point), function(point)
                assert found == pytest.approx(expected, rel=1e-9, abs=1e-12), (
                    f"{part} of {law.name} at {where(law, point)}: expected {expected}, found {found}"
                )
                assert guard >= 0.0, (
                    f"the distance to the end of the branch of {law.name} at {where(law, point)}, which is on it: "
                    f"expected 0 or more, found {guard:g}"
                )

    def test_the_engine_derives_the_functions_right(self, law: type[SpringLaw], probe: Probe, derived: list[Derived]) -> None:
        for one in derived:
            for point in probe.points():
                for name, found, expected, error in one.slopes(point):
                    assert abs(found - expected) <= error, (
                        f"the derivative of {one.function.part} of {law.name} to {name} at {where(law, point)}: "
                        f"expected {expected:g}, found {found:g}"
                    )

    def test_a_branch_says_where_it_ends(self, law: type[SpringLaw], probe: Probe, derived: list[Derived]) -> None:
        points = list(probe.points())
        for one in (one for one in derived if has_own_branches(one.function)):
            distances = (abs(one.value(point)[1]) for point in points)
            scale = max((distance for distance in distances if np.isfinite(distance)), default=1.0)
            for start, end in zip(points, points[1:], strict=False):
                if one.mode(start) != one.mode(end):
                    mode = one.mode(start)
                    inside, outside = branch_end(one, start, end)
                    found = one.value(inside, mode)[1], one.value(outside, mode)[1]
                    assert found[0] >= -1e-9 * scale and found[1] <= 1e-9 * scale, (
                        f"branch {mode} of {law.name} ends at {where(law, inside)}: expected its distance to vanish there, "
                        f"found {found[0]:g} within and {found[1]:g} beyond"
                    )

    def test_branches_of_its_own_can_be_compiled(self, law: type[SpringLaw], probe: Probe, derived: list[Derived]) -> None:
        for one in (one for one in derived if has_own_branches(one.function)):
            try:
                compile_own(one.function, next(probe.points()), one.vector)
            except CrashkitError as error:
                pytest.fail(str(error))


def _like(parameter: object, value: float) -> float | list[float]:
    """The value, or a list of it where the parameter is one."""
    return [value] * len(parameter) if isinstance(parameter, list | tuple | np.ndarray) else value


def _undeclared(law: type[SpringLaw]) -> str:
    """What keeps a law from being tested at all, in words; empty where nothing does."""
    name, parameters = getattr(law, "name", ""), getattr(law, "parameters", None)
    if not (isinstance(name, str) and name):
        return f'the class {law.__name__}: expected the name that model files write (name = "..."), found none'
    if not isinstance(parameters, tuple) or not all(isinstance(spec, ParameterSpec) for spec in parameters):
        found = type(parameters).__name__
        return f"the parameters of {name}: expected a tuple of ParameterSpec (with a comma behind a single one), found {found}"
    for part in ("force", "memory_rate") if law.memory else ("force",):
        found = inspect.getattr_static(law, part, None)
        if not isinstance(found, staticmethod):
            return f"{part} of {name}: expected a function under @staticmethod, found {type(found).__name__}"
    return ""
