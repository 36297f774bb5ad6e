"""The contract of spring laws finds each fault that it is there for."""

import math
from typing import ClassVar

import pytest

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit.testing import SpringLawContract
from crashkit.testing.spring_law_probe import Probe

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
    probe = Probe(law, parameters)
    make = {"derived": lambda: type(contract).derived.__wrapped__(contract, probe)}
    given = {"law": lambda: law, "parameters": lambda: parameters, "probe": lambda: probe, **make}
    method = getattr(contract, test)
    names = method.__code__.co_varnames[1 : method.__code__.co_argcount]
    method(**{name: given[name]() for name in names})


FAULTS = [
    (
        "test_the_functions_take_the_state_and_the_declared_parameters",
        spoilt(parameters=(STIFFNESS, ParameterSpec("damping", "N s m-1", "never used"))),
        "expected d, ddot, d_max, stiffness, damping, found d, ddot, d_max, stiffness",
    ),
    ("test_names_and_units_are_those_of_the_data_contract", spoilt(unit="kN"), 'expected "N" .* found "kN"'),
    (
        "test_names_and_units_are_those_of_the_data_contract",
        spoilt(parameters=(ParameterSpec("stiffness", "N/m", "slope"),)),
        'the unit of stiffness: expected an SI unit of kg, m, .* such as "N m-1", found "N/m"',
    ),
    (
        "test_names_and_units_are_those_of_the_data_contract",
        spoilt(parameters=(ParameterSpec("stiffness", "N mm-1", "slope"),)),
        'the unit of stiffness: expected an SI unit of kg, m, .*, found "N mm-1"',
    ),
    (
        "test_names_and_units_are_those_of_the_data_contract",
        spoilt(name="log + foam"),
        'the name of Spoilt: expected an identifier, as a space or a sign combines laws, found "log [+] foam"',
    ),
    (
        "test_names_and_units_are_those_of_the_data_contract",
        spoilt(name="log foam"),
        'the name of Spoilt: expected an identifier, .*, found "log foam"',
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
        "force of linear at d = .* expected a finite value, found inf",
    ),
    (
        "test_the_value_is_continuous_or_declared_to_jump",
        law_of(lambda d, ddot, d_max: 1e5 * d + (50.0 if d > 0.3 else 0.0)),
        r"force of linear jumps by 50 at d = 0.3 m, .*: expected a continuous value \(or jumps = True\)",
    ),
    (
        "test_the_value_is_continuous_or_declared_to_jump",
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
    (
        "test_a_driven_law_is_one_smooth_piece",
        spoilt(driven=True),
        "linear is driven: expected one smooth piece, .* found the end of a branch near d = ",
    ),
    (
        "test_a_jump_does_not_hold_the_joint",
        law_of(lambda d, ddot, d_max: 1e5 * max(0.0, d) * (1.5 if ddot > 0.0 else 0.5), jumps=True),
        r"linear rises by a jump of .* with the rate at d = .*: expected a smooth rise, such as tanh\(ddot / slip_rate\)",
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
    with pytest.raises(pytest.fail.Exception, match="expected a value for stiffness, which has no default"):
        run("test_the_value_is_finite", Linear, {})


DECLARED = "test_the_class_declares_a_name_parameters_and_functions"
UNDECLARED = [
    (spoilt(name=""), "the class Spoilt: expected the name that model files write .*, found none"),
    (spoilt(parameters=STIFFNESS), r"the parameters of linear: expected a tuple .* \(with a comma .*\), found ParameterSpec"),
    (spoilt(force=lambda self, d, ddot, d_max, stiffness: d), "force of linear: expected .* @staticmethod, found function"),
]


@pytest.mark.parametrize(("law", "message"), UNDECLARED, ids=["name", "parameters", "staticmethod"])
def test_what_is_not_declared_is_told_before_anything_else(law, message):
    with pytest.raises(AssertionError, match=message):
        run(DECLARED, law)
    with pytest.raises(pytest.fail.Exception, match=message):
        SpringLawContract.probe.__wrapped__(SpringLawContract(), law, PARAMETERS)


BROKEN = [
    (lambda d, ddot, d_max: math.sqrt(d), "force of linear at d = -.*: expected a number, found ValueError: .*"),
    (lambda d, ddot, d_max: 1e5 if d > 0.0 else None, "expected a number, found None: a way through it ends without a return"),
]


@pytest.mark.parametrize(("function", "message"), BROKEN, ids=["raises", "no return"])
def test_what_a_law_does_instead_of_a_number_is_told_with_the_state(function, message):
    with pytest.raises(pytest.fail.Exception, match=message):
        run("test_the_value_is_finite", law_of(function))


def test_an_instance_in_place_of_the_class_is_found():
    with pytest.raises(AssertionError, match="the fixture law: expected the class, found the instance"):
        run("test_the_functions_take_the_state_and_the_declared_parameters", Linear())


# ---- memory ----


class Relaxing(SpringLaw):
    """A law with a memory, without fault."""

    name = "relaxing"
    memory = "q"
    parameters: ClassVar = (STIFFNESS,)

    @staticmethod
    def force(d, ddot, d_max, q, stiffness):
        return stiffness * (d - q)

    @staticmethod
    def memory_rate(d, ddot, d_max, q, stiffness):
        return (d - q) / 0.02


class TestRelaxing(SpringLawContract):
    @pytest.fixture
    def law(self):
        return Relaxing

    @pytest.fixture
    def parameters(self):
        return PARAMETERS


class Forgetful(SpringLaw):
    """Names a memory, and nothing else of it."""

    name = "forgetful"
    memory = "q"
    parameters: ClassVar = (STIFFNESS,)

    @staticmethod
    def force(d, ddot, d_max, q, stiffness):
        return stiffness * (d - q)


def remembering(rate, **attributes):
    function = staticmethod(lambda d, ddot, d_max, q, stiffness: rate(d, ddot, d_max, q))
    return type("Spoilt", (Relaxing,), {"memory_rate": function, **attributes})


MEMORY_FAULTS = [
    (
        "test_the_functions_take_the_state_and_the_declared_parameters",
        Forgetful,
        "forgetful has a memory, q: expected memory_rate, found none",
    ),
    (
        "test_the_functions_take_the_state_and_the_declared_parameters",
        type("Spoilt", (Relaxing,), {"memory_rate": staticmethod(lambda d, q: 0.0)}),
        "the arguments of memory_rate: expected d, ddot, d_max, q, stiffness, found d, q",
    ),
    (
        "test_names_and_units_are_those_of_the_data_contract",
        type("Spoilt", (Relaxing,), {"memory": "dashpot deformation"}),
        "the memory of relaxing: expected an identifier, found 'dashpot deformation'",
    ),
    (
        "test_a_memory_rests_where_nothing_happens",
        remembering(lambda d, ddot, d_max, q: 0.1 + d - q),
        r"the memory of relaxing, undeformed, at rest and at 0: expected a rate of 0 \(or preload = True\), found 0.1",
    ),
    (
        "test_the_value_is_continuous_or_declared_to_jump",
        remembering(lambda d, ddot, d_max, q: (1.0 if d > 0.3 else 0.0) - q),
        "memory_rate of relaxing jumps by 1 at d = 0.3 m, .*, q = .*: expected a continuous value",
    ),
    (
        "test_a_passive_law_gives_out_no_more_energy_than_it_took_in",
        remembering(lambda d, ddot, d_max, q: (q - d) / 0.2),
        "relaxing gave out .* J more than it took in",
    ),
]


@pytest.mark.parametrize(("test", "law", "message"), MEMORY_FAULTS, ids=[row[2][:30] for row in MEMORY_FAULTS])
def test_a_fault_of_a_memory_is_found(test, law, message):
    with pytest.raises(AssertionError, match=message):
        run(test, law)


# ---- what the engine makes of a law ----


class Looping(Linear):
    """Outside what can be derived."""

    @staticmethod
    def force(d, ddot, d_max, stiffness):
        while d > 1.0:
            d = 1.0
        return stiffness * max(0.0, d)


class Bent(Linear):
    """Branches of its own, without fault: k d, then twice as steep from BEND on."""

    BEND = 0.3

    @staticmethod
    def force(d, ddot, d_max, stiffness):
        return stiffness * (d + max(0.0, d - Bent.BEND))

    @staticmethod
    def branch(d, ddot, d_max, stiffness):
        return 1 if d > Bent.BEND else 0

    @staticmethod
    def branch_force(branch, d, ddot, d_max, stiffness):
        beyond = d - Bent.BEND
        return stiffness * (d + branch * beyond), beyond if branch == 1 else -beyond

    @staticmethod
    def branch_slopes(branch, d, ddot, d_max, stiffness, slopes):
        slopes[:] = 0.0
        slopes[0] = stiffness * (1.0 + branch)
        slopes[3] = d + branch * (d - Bent.BEND)


class TestBent(SpringLawContract):
    @pytest.fixture
    def law(self):
        return Bent

    @pytest.fixture
    def parameters(self):
        return PARAMETERS


class WrongForce(Bent):
    @staticmethod
    def branch_force(branch, d, ddot, d_max, stiffness):
        return stiffness * d, d - 0.3 if branch == 1 else 0.3 - d


class WrongSlopes(Bent):
    @staticmethod
    def branch_slopes(branch, d, ddot, d_max, stiffness, slopes):
        slopes[:] = 0.0
        slopes[0] = stiffness


class WrongSide(Bent):
    @staticmethod
    def branch_force(branch, d, ddot, d_max, stiffness):
        return stiffness * (d + branch * (d - 0.3)), d - 0.3


class WrongEnd(Bent):
    @staticmethod
    def branch_force(branch, d, ddot, d_max, stiffness):
        return stiffness * (d + branch * (d - 0.3)), d - 0.2 if branch == 1 else 0.4 - d


class NotCompiled(Bent):
    @staticmethod
    def branch_slopes(branch, d, ddot, d_max, stiffness, slopes):
        slopes[:] = 0.0
        slopes[0] = stiffness if branch == 0 else "steep"
        slopes[3] = d


OWN_FAULTS = [
    ("test_the_engine_reads_the_functions_right", WrongForce, r"force of linear at d = .*: expected .*, found"),
    (
        "test_the_engine_derives_the_functions_right",
        WrongSlopes,
        "the derivative of force of linear to d at .*: expected 200000",
    ),
    ("test_the_engine_derives_the_functions_right", WrongSlopes, "the derivative of force of linear to .* found"),
    ("test_the_engine_reads_the_functions_right", WrongSide, "the distance to the end of the branch of linear at .*, found -"),
    (
        "test_a_branch_says_where_it_ends",
        WrongEnd,
        r"branch \d of linear ends at d = 0.3 m, .*: expected its distance to vanish",
    ),
]


@pytest.mark.parametrize(("test", "law", "message"), OWN_FAULTS, ids=lambda value: getattr(value, "__name__", None))
def test_a_fault_of_branches_of_its_own_is_found(test, law, message):
    with pytest.raises(AssertionError, match=message):
        run(test, law)


def test_what_numba_cannot_compile_is_found():
    with pytest.raises(pytest.fail.Exception, match="spring law linear: numba cannot compile its branches: "):
        run("test_branches_of_its_own_can_be_compiled", NotCompiled)


def test_a_law_that_cannot_be_derived_is_told_its_three_ways_out():
    message = (
        r"found `while d > 1.0:`; use assignments, .*\. Else give branch, .*, or declare opaque = True: then the law runs as"
    )
    with pytest.raises(pytest.fail.Exception, match=message):
        run("test_the_engine_reads_the_functions_right", Looping)


def test_an_opaque_law_is_not_derived():
    with pytest.raises(pytest.skip.Exception, match="linear is declared opaque: it runs slowly and gives no sensitivities"):
        run("test_the_engine_reads_the_functions_right", type("Meant", (Looping,), {"opaque": True}))
