"""The contract of spring laws finds each fault that it is there for."""

import math
from typing import ClassVar

import pytest

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.testing import SpringLawContract

STIFFNESS = ParameterSpec("stiffness", "N m-1", "slope", lower=1.0)
PARAMETERS = {"stiffness": 1e5}


class Linear(SpringLaw):
    """A law without fault; each test spoils one thing."""

    name = "linear"
    parameters: ClassVar = (STIFFNESS,)

    @staticmethod
    def force(d, ddot, d_max, stiffness):
        return stiffness * max(0.0, d)


class TestLinear(SpringLawContract):
    @pytest.fixture
    def law(self):
        return Linear

    @pytest.fixture
    def parameters(self):
        return PARAMETERS


def spoilt(**attributes):
    return type("Spoilt", (Linear,), attributes)


def law_of(function, **attributes):
    return spoilt(force=staticmethod(lambda d, ddot, d_max, stiffness: function(d, ddot, d_max)), **attributes)


def factor_of(function):
    spec = ParameterSpec("rate_coefficient", "s m-1", "relative rise", null=0.0)
    force = staticmethod(lambda d, ddot, d_max, rate_coefficient: function(ddot, rate_coefficient))
    return spoilt(unit="1", parameters=(spec,), force=force)


def run(test, law, parameters=PARAMETERS):
    """Run one test of the contract with the fixtures that it asks for."""
    contract = SpringLawContract()
    values = [parameters.get(spec.name, spec.default) for spec in law.parameters]
    given = {"law": law, "parameters": parameters, "force": lambda d, ddot, d_max: float(law.force(d, ddot, d_max, *values))}
    method = getattr(contract, test)
    names = method.__code__.co_varnames[1 : method.__code__.co_argcount]
    method(**{name: given[name] for name in names})


FAULTS = [
    (
        "test_the_function_takes_the_state_and_the_declared_parameters",
        spoilt(parameters=(STIFFNESS, ParameterSpec("damping", "N s m-1", "never used"))),
        "expected d, ddot, d_max, stiffness, damping, found d, ddot, d_max, stiffness",
    ),
    ("test_names_and_units_are_those_of_the_data_contract", spoilt(unit="kN"), 'expected "N" .* found "kN"'),
    (
        "test_names_and_units_are_those_of_the_data_contract",
        spoilt(parameters=(ParameterSpec("stiffness", "N/m", "slope"),)),
        'the unit of stiffness: expected a CF unit such as "N m-1", found "N/m"',
    ),
    (
        "test_names_and_units_are_those_of_the_data_contract",
        spoilt(parameters=(ParameterSpec("stiffness", "N m-1", ""),)),
        "the meaning of stiffness: expected a phrase, found none",
    ),
    (
        "test_defaults_lie_within_bounds_or_take_the_physics_away",
        spoilt(parameters=(ParameterSpec("stiffness", "N m-1", "slope", lower=1.0, default=0.0),)),
        "the default of stiffness: expected within its bounds or its null, found 0.0",
    ),
    (
        "test_defaults_lie_within_bounds_or_take_the_physics_away",
        spoilt(parameters=(ParameterSpec("stiffness", "N m-1", "slope", lower=2.0, upper=1.0),)),
        "the bounds of stiffness: expected lower < upper, found 2.0, 1.0",
    ),
    (
        "test_the_value_is_finite",
        law_of(lambda d, ddot, d_max: math.inf if d > 0.5 else 0.0),
        "linear at d = .* expected a finite value, found inf",
    ),
    (
        "test_the_value_is_continuous",
        law_of(lambda d, ddot, d_max: 1e5 * d + (50.0 if d > 0.3 else 0.0)),
        "linear jumps by 50 at d = 0.3 m",
    ),
    (
        "test_the_value_is_continuous",
        law_of(lambda d, ddot, d_max: 1e5 * d if d == d_max else 5e4 * d),
        "linear jumps by",
    ),
    (
        "test_no_deformation_no_force",
        law_of(lambda d, ddot, d_max: 1e5 * d + 3.0),
        r"linear undeformed and at rest: expected no force \(or preload = True\), found 3 N",
    ),
    (
        "test_a_passive_law_gives_out_no_more_energy_than_it_took_in",
        law_of(lambda d, ddot, d_max: 1e5 * d * (1.0 - 0.01 * ddot)),
        "linear gave out .* J more than it took in",
    ),
    (
        "test_a_passive_law_gives_out_no_more_energy_than_it_took_in",
        law_of(lambda d, ddot, d_max: 1e5 * max(0.0, d) + 2e4 * (d_max - max(0.0, d))),
        "linear gave out .* J more than it took in",
    ),
    (
        "test_a_factor_is_one_where_its_physics_is_absent",
        factor_of(lambda ddot, a: max(0.0, 1.1 + a * ddot)),
        "linear at its null .* expected 1, found 1.1",
    ),
    (
        "test_a_factor_never_turns_a_force_round",
        factor_of(lambda ddot, a: 1.0 + a * ddot),
        "expected 0 or more, found -",
    ),
]


@pytest.mark.parametrize(("test", "law", "message"), FAULTS, ids=[f"{number}-{row[0]}" for number, row in enumerate(FAULTS)])
def test_a_fault_is_found(test, law, message):
    with pytest.raises(AssertionError, match=message):
        run(test, law, {"rate_coefficient": 1.0} if law.unit == "1" else PARAMETERS)


def test_a_value_outside_its_bounds_is_found():
    with pytest.raises(AssertionError, match="the value of stiffness: expected within 1.0 to inf, found 0.5"):
        run("test_the_tested_values_lie_within_bounds", Linear, {"stiffness": 0.5})


def test_a_value_of_no_parameter_is_found():
    with pytest.raises(AssertionError, match="the fixture parameters: linear declares no stifness"):
        run("test_the_tested_values_lie_within_bounds", Linear, {"stifness": 1e5})


def test_an_active_law_may_say_so():
    active = law_of(lambda d, ddot, d_max: 1e5 * d * (1.0 - 0.01 * ddot), passive=False)
    run("test_a_passive_law_gives_out_no_more_energy_than_it_took_in", active)


def test_a_parameter_without_a_value_is_named():
    contract = SpringLawContract()
    with pytest.raises(pytest.fail.Exception, match="expected a value for stiffness, which has no default"):
        type(contract).force.__wrapped__(contract, Linear, {})
