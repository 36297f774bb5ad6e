"""Laws that cannot be derived: run as plain Python, or with branches that their author gives."""

from typing import ClassVar

import numpy as np
import pytest
from attrs import evolve

from crashkit.errors import CrashkitError, SimulationError
from crashkit.mechanics import LawFunction, Simulator, compile_engine, functions_of
from crashkit.mechanics.laws.emit import emit
from crashkit.mechanics.laws.opaque import OpaqueLawWarning
from crashkit.mechanics.laws.plain import plain
from crashkit.protocols import ParameterSpec, SpringLaw

TIMES = np.linspace(0.0, 2.0, 21)
STEP = 1e-3
STIFFNESS = ParameterSpec("k", "N m-1", "slope")


class Opaque(SpringLaw):
    """A Maxwell element that adds up a vector with `while`; its author means it to run as plain Python."""

    name = "opaque"
    memory = "q"
    opaque = True
    parameters: ClassVar = (
        STIFFNESS,
        ParameterSpec("shares", "1", "of the slope", vector=True),
        ParameterSpec("tau", "s", "time"),
    )

    @staticmethod
    def force(d, ddot, d_max, q, k, shares, tau):
        total, n = 0.0, 0
        while n < len(shares):
            total += shares[n]
            n += 1
        return k * total * (d - q)

    @staticmethod
    def memory_rate(d, ddot, d_max, q, k, shares, tau):
        return (d - q) / tau


class Failing(SpringLaw):
    """Goes wrong when it is pressed."""

    name = "failing"
    opaque = True
    parameters: ClassVar = (STIFFNESS,)

    @staticmethod
    def force(d, ddot, d_max, k):
        return [0.0][int(10.0 * max(0.0, d))]


class Unmeant(SpringLaw):
    """Outside the subset, though its author does not say so."""

    name = "unmeant"
    parameters: ClassVar = (STIFFNESS,)

    @staticmethod
    def force(d, ddot, d_max, k):
        return sum([k * max(0.0, d)])


LAWS = {law.name: law for law in (Opaque, Failing, Unmeant)}


@pytest.fixture(scope="module")
def models(against_wall):
    return {
        "opaque": against_wall("opaque", {"k": 1.3, "shares": [0.25, 0.75], "tau": 0.4}, mass=1.2),
        "failing": against_wall("failing", {"k": 1.0}),
        "unmeant": against_wall("unmeant", {"k": 1.3}),
    }


@pytest.fixture(scope="module")
def opaque(models):
    functions = frozenset().union(*(functions_of(model, LAWS) for model in models.values()))
    with pytest.warns(OpaqueLawWarning, match="it runs as plain Python, slowly") as told:
        engine = compile_engine(functions)
    assert sum(str(one.message).startswith("spring law opaque: declared opaque:") for one in told) == 2  # force, memory_rate
    return {name: Simulator(model, LAWS, engine) for name, model in models.items()}


def test_it_computes_what_a_derived_law_computes(opaque, simulator, against_wall):
    parameters = {"relaxing_stiffness": 1.3, "relaxation_time": 0.4, "tension": 1.0}
    derived = simulator(against_wall("maxwell", parameters, mass=1.2))
    expected, found = (one.run(TIMES, step=STEP) for one in (derived, opaque["opaque"]))
    np.testing.assert_allclose(found["position"].values, expected["position"].values, atol=1e-13)
    np.testing.assert_allclose(found["force"].values, expected["force"].values, atol=1e-13)


def test_values_reach_it(opaque):
    harder = opaque["opaque"].run(TIMES, {"joint.spring.shares[1]": 1.75}, step=STEP)
    same = opaque["opaque"].run(TIMES, {"joint.spring.k": 2.6}, step=STEP)
    np.testing.assert_allclose(harder["position"].values, same["position"].values, atol=1e-13)


def test_the_warning_names_law_line_and_remedy(models):
    message = (
        r"spring law unmeant \(.*test_opaque.py:\d+\): found `\[k \* max.*\]`; use assignments, .*: it runs as plain Python"
    )
    with pytest.warns(OpaqueLawWarning, match=message):
        compile_engine(functions_of(models["unmeant"], LAWS), axes=2)


@pytest.mark.parametrize("name", ["opaque", "unmeant"])
def test_no_sensitivities_are_offered(opaque, name):
    message = f"expected laws that give sensitivities, found {name}, which runs as plain Python"
    with pytest.raises(CrashkitError, match=message):
        opaque[name].run(TIMES, sensitivities=["body.mass.mass"])
    with pytest.raises(CrashkitError, match=message):
        opaque[name].adjoint(TIMES, opaque[name].run(TIMES)[["position"]], parameters=["body.mass.mass"])


def test_what_goes_wrong_in_it_is_told(opaque):
    message = (
        r"the force of joint spring .* is not finite \(failing at d = 0\.\d+ m, .*: IndexError: list index out of range\)"
    )
    with pytest.raises(SimulationError, match=message):
        opaque["failing"].run(TIMES, step=STEP)


# ---- branches of its own ----

RISE = 0.5


def segment(x, corners):
    """How many corners lie below: a loop that no derivation reads."""
    count = 0
    while count < len(corners) and x >= corners[count]:
        count += 1
    return count


class OwnBranches(SpringLaw):
    """A line bent at some deformations, each time by RISE: F = k x + RISE sum_i max(0, x - corners[i])."""

    name = "own_branches"
    parameters: ClassVar = (STIFFNESS, ParameterSpec("corners", "m", "bends", vector=True))

    @staticmethod
    def force(d, ddot, d_max, k, corners):
        branch = OwnBranches.branch(d, ddot, d_max, k, corners)
        return OwnBranches.branch_force(branch, d, ddot, d_max, k, corners)[0]

    @staticmethod
    def branch(d, ddot, d_max, k, corners):
        return segment(d, corners)

    @staticmethod
    def branch_force(branch, d, ddot, d_max, k, corners):
        force = k * d
        for i in range(branch):
            force += RISE * (d - corners[i])
        distance = np.inf
        if branch > 0:
            distance = d - corners[branch - 1]
        if branch < len(corners):
            distance = min(distance, corners[branch] - d)
        return force, distance

    @staticmethod
    def branch_slopes(branch, d, ddot, d_max, k, corners, slopes):
        slopes[:] = 0.0
        slopes[0] = k + branch * RISE
        slopes[3] = d
        slopes[4 : 4 + branch] = -RISE


class Derived(SpringLaw):
    """The same, written so that it can be derived."""

    name = "derived"
    parameters: ClassVar = OwnBranches.parameters

    @staticmethod
    def force(d, ddot, d_max, k, corners):
        force = k * d
        for corner in corners:
            force += RISE * max(0.0, d - corner)
        return force


def test_branches_of_its_own_are_as_good_as_derived_ones(against_wall):
    laws = {law.name: law for law in (OwnBranches, Derived)}
    model = against_wall("own_branches", {"k": 1.0, "corners": [0.2, 0.5, 0.9, 3.0]})
    joint = evolve(model.joints[0], law="derived")
    paths = [*(path for path in model.parameters() if path.startswith("joint")), "body.mass.mass"]
    engine = compile_engine([LawFunction(law, (4,)) for law in laws.values()])
    found, expected = (
        Simulator(one, laws, engine).run(TIMES, sensitivities=paths, step=STEP)
        for one in (model, evolve(model, joints=(joint,)))
    )
    for name in ("position", "force", "position_sensitivity", "force_sensitivity"):
        np.testing.assert_allclose(found[name].values, expected[name].values, atol=1e-12)


def own(**changes):
    return type("Changed", (OwnBranches,), changes)


def not_for_numba(branch, d, ddot, d_max, k, corners):
    return open(k), 0.0


def other_arguments(branch, d, ddot, d_max, corners):
    return d, 0.0


REFUSED = [
    ({"branch_slopes": None}, "expected branch, branch_force, branch_slopes together, found no branch_slopes"),
    (
        {"branch_force": staticmethod(other_arguments)},
        "expected branch_force to take branch, d, .*, k, corners, found branch",
    ),
    ({"branch_force": staticmethod(not_for_numba)}, r"found `open`; use numbers, math, numpy as it is, and functions that do"),
    ({"jumps": True}, "expected a law with branches of its own to be continuous, found jumps = True; keep what jumps to"),
]


@pytest.mark.parametrize(("changes", "message"), REFUSED)
def test_what_is_wrong_with_branches_of_its_own_is_told(changes, message):
    with pytest.raises(CrashkitError, match=f"spring law own_branches.*{message}"):
        emit(LawFunction(own(**changes), (2,)))


def test_pasted_functions_know_their_constants():
    functions = plain(LawFunction(OwnBranches, (2,)))
    numbers = np.array([1.0, 0.2, 0.4])
    mode = functions.mode(0.3, 0.0, 0.3, 0.0, numbers, 0)
    assert functions.frozen(mode, 0.3, 0.0, 0.3, 0.0, numbers, 0) == pytest.approx((0.35, 0.1))
    assert "segment" in emit(LawFunction(OwnBranches, (2,)))
