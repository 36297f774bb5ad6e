"""The sensitivity method against known answers: toys, linear least squares, and the noise of repeated tests."""

import numpy as np
import pytest
import xarray as xr
from attrs import define, evolve
from scipy.optimize import lsq_linear

from crashkit.errors import SimulationError
from crashkit.mechanics import Simulator
from crashkit.misfit import Misfit
from crashkit.protocols import Status
from crashkit.registry import load
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity


@define
class Linear:
    """r(u) = A u - b, with some of the parameters searched in their logarithms (then r = A exp(u) - b)."""

    matrix: np.ndarray
    target: np.ndarray
    first: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    log: np.ndarray

    @property
    def names(self):
        return tuple("abcdefgh"[: len(self.first)])

    def start(self):
        return self._scaled(self.first)

    def bounds(self):
        return self._scaled(self.lower), self._scaled(self.upper)

    def residual(self, scaled):
        return self.matrix @ self.parameters(scaled) - self.target

    def residual_and_jacobian(self, scaled):
        return self.residual(scaled), self.matrix * self.scaling(scaled)

    def parameters(self, scaled):
        return np.where(self.log, np.exp(np.where(self.log, scaled, 0.0)), scaled)

    def scaling(self, scaled):
        return np.where(self.log, self.parameters(scaled), 1.0)

    def _scaled(self, values):
        return np.where(self.log, np.log(np.where(self.log, values, 1.0)), values)


def linear(matrix, target, first, lower=-np.inf, upper=np.inf, log=False):
    count = len(first)
    wide = [np.broadcast_to(value, count) for value in (lower, upper, log)]
    return Linear(np.array(matrix, float), np.array(target, float), np.array(first, float), *wide)


MATRIX = np.random.default_rng(0).normal(size=(40, 3))
TRUTH = np.array([1.0, -2.0, 0.5])


class TestSensitivity(IdentifierContract):
    @pytest.fixture
    def identifier(self):
        return Sensitivity()


def exact(truth, speeds):
    """A toy whose recordings are not even rounded, started 20 % off."""
    registry = load()
    return toys.problem(truth, toys.start_from(truth, 0.8), registry.spring_laws, registry.observers, speeds, exact=True)


@pytest.mark.parametrize(
    ("truth", "speeds"),
    [(toys.one_degree(), (1.0,)), (toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED), (1.0, 1.5))],
    ids=["one degree", "two degrees"],
)
def test_a_model_is_recovered_from_its_own_motion(truth, speeds):
    found = run(Sensitivity(), exact(truth, speeds))
    assert found.status is Status.CONVERGED
    for path, parameter in truth.free_parameters().items():
        assert found.values[path] == pytest.approx(parameter.value, rel=1e-8), path


def test_a_linear_problem_has_the_covariance_of_linear_regression():
    noisy = MATRIX @ TRUTH + np.random.default_rng(1).normal(size=40)
    found = run(Sensitivity(), linear(MATRIX, noisy, np.zeros(3)))
    best, cost, *_ = np.linalg.lstsq(MATRIX, noisy)
    assert found.parameters["value"].values == pytest.approx(best)
    assert found.parameters["covariance"].values == pytest.approx(np.linalg.inv(MATRIX.T @ MATRIX))
    assert found.cost == pytest.approx(0.5 * float(cost[0]))
    assert found.parameters["identifiable"].values.all() and not found.unseen


def test_the_covariance_of_a_logarithm_is_told_in_the_parameters_own_unit():
    truth = np.array([2.0, 30.0, 0.4])
    found = run(Sensitivity(), linear(MATRIX, MATRIX @ truth, truth * 1.2, 1e-3, 1e3, log=True))
    assert found.parameters["value"].values == pytest.approx(truth)
    assert found.parameters["covariance"].values == pytest.approx(np.linalg.inv(MATRIX.T @ MATRIX), rel=1e-6)


def test_the_stated_deviation_is_the_scatter_of_repeated_tests():
    truth = toys.one_degree()
    problem, random, registry = exact(truth, (1.0,)), np.random.default_rng(2), load()
    values = []
    for _ in range(30):
        noisy = {run: toys.noisy(tree, 0.01, random) for run, tree in problem.recordings.items()}
        found = run(Sensitivity(least_drop=1e-3), Misfit(truth, noisy, registry.spring_laws, registry.observers))
        values.append(found.parameters["value"].values)
    stated = found.parameters["std"].values
    assert np.std(values, axis=0, ddof=1) == pytest.approx(stated, rel=0.45)  # 3.4 sigma of 30 draws
    bias = np.mean(values, axis=0) - [parameter.value for parameter in truth.free_parameters().values()]
    assert np.all(np.abs(bias) < 4.0 * stated / np.sqrt(30.0))


def test_within_bounds_it_finds_what_bounded_least_squares_finds():
    random = np.random.default_rng(0)
    for _ in range(30):
        matrix, target = random.normal(size=(6, 3)), 5.0 * random.normal(size=6)
        lower, upper = -random.uniform(0.1, 2.0, 3), random.uniform(0.1, 2.0, 3)
        found = run(Sensitivity(), linear(matrix, target, np.zeros(3), lower, upper))
        best = lsq_linear(matrix, target, (lower, upper), tol=1e-14)
        assert found.cost == pytest.approx(best.cost, rel=1e-6, abs=1e-9)
        assert np.all((found.parameters["value"].values >= lower) & (found.parameters["value"].values <= upper))


def test_a_parameter_at_its_bound_says_so_and_has_no_deviation():
    table = run(Sensitivity(), linear(MATRIX, MATRIX @ TRUTH, np.zeros(3), -1.0, 3.0)).parameters
    assert table["at_bound"].values.tolist() == [False, True, False]
    assert table["value"].values[1] == -1.0
    assert np.isnan(table["std"].values[1])
    assert not table["identifiable"].values[1]
    others = MATRIX[:, [0, 2]]
    assert table["covariance"].values[np.ix_([0, 2], [0, 2])] == pytest.approx(np.linalg.inv(others.T @ others))


def test_a_start_outside_the_bounds_is_brought_inside():
    found = run(Sensitivity(), linear(MATRIX, MATRIX @ TRUTH, np.full(3, 50.0), -5.0, 5.0))
    assert found.parameters["value"].values == pytest.approx(TRUTH)


def test_a_parameter_that_the_data_do_not_see_is_named():
    blind = MATRIX * [1.0, 0.0, 1.0]
    found = run(Sensitivity(), linear(blind, blind @ TRUTH, np.ones(3)))
    assert found.unseen == ("b is not seen by these recordings",)
    assert found.parameters["identifiable"].values.tolist() == [True, False, True]


@pytest.mark.parametrize(("sign", "told"), [(1.0, "-"), (-1.0, "+")])
def test_a_combination_that_the_data_do_not_see_is_named(sign, told):
    matrix = MATRIX.copy()
    matrix[:, 2] = sign * matrix[:, 0]
    found = run(Sensitivity(), linear(matrix, matrix @ [2.0, 1.0, 2.0], [1.5, 1.0, 1.5]))
    assert len(found.unseen) == 1
    first, second = ("a", "c") if found.unseen[0].startswith("only a combination is seen: a") else ("c", "a")
    assert found.unseen == (f"only a combination is seen: {first} (+), {second} ({told}) can change together",)
    assert found.parameters["identifiable"].values.tolist() == [False, True, False]


def test_a_search_that_runs_out_of_steps_says_so():
    found = run(Sensitivity(step_limit=2), exact(toys.one_degree(), (1.0,)))
    assert found.status is Status.STEP_LIMIT


class Unstable(Linear):
    """Cannot be simulated."""

    def residual_and_jacobian(self, scaled):
        raise SimulationError("no progress")


def test_a_model_that_cannot_be_simulated_is_a_failure_and_no_crash():
    problem = Unstable(MATRIX, MATRIX @ TRUTH, np.zeros(3), np.full(3, -9.0), np.full(3, 9.0), np.zeros(3, dtype=bool))
    found = run(Sensitivity(), problem)
    assert found.status is Status.FAILED
    assert found.parameters["value"].values.tolist() == [0.0, 0.0, 0.0]


class Misleading(Linear):
    """Its derivatives point uphill."""

    def residual_and_jacobian(self, scaled):
        return self.residual(scaled), -self.matrix


def test_a_search_that_finds_no_acceptable_step_has_stalled():
    problem = Misleading(MATRIX, MATRIX @ TRUTH, np.zeros(3), np.full(3, -9.0), np.full(3, 9.0), np.zeros(3, dtype=bool))
    found = run(Sensitivity(), problem)
    assert found.status is Status.STALLED
    assert found.parameters["value"].values == pytest.approx(0.0)


def test_the_path_only_goes_down():
    found = run(Sensitivity(), exact(toys.one_degree(), (1.0,)))
    cost = found.path["cost"].values
    assert len(cost) > 3 and np.all(np.diff(cost) < 0.0)
    assert found.path["value"].values[-1] == pytest.approx(found.parameters["value"].values)


def test_a_search_goes_on_from_where_it_was_stopped():
    problem, method = exact(toys.one_degree(), (1.0,)), Sensitivity()
    state = method.start(problem)
    for _ in range(3):
        state = method.step(problem, state)
    fresh = exact(toys.one_degree(), (1.0,))
    while state.status is Status.RUNNING:
        state = Sensitivity().step(fresh, state)
    assert method.finish(fresh, state).values == run(method, problem).values


def recording(speed):
    model = toys.one_degree()
    simulator = Simulator(model, load().spring_laws)
    motion = simulator.run(np.linspace(0.0, 0.3, 301), initial=toys.initial_state(model, speed), step=5e-4)
    return toys.recording(motion)


@pytest.fixture(scope="module")
def slow_and_fast() -> dict[str, xr.DataTree]:
    return {"slow": recording(0.35), "fast": recording(1.3)}


def misfit(runs):
    start = toys.start_from(toys.one_degree(), 0.9)
    return Misfit(start, runs, load().spring_laws, load().observers)


def test_a_slow_test_does_not_see_what_only_a_fast_one_reaches(slow_and_fast):
    found = run(Sensitivity(), misfit({"slow": slow_and_fast["slow"]}))
    seen = dict(zip(found.parameters["parameter"].values, found.parameters["identifiable"].values, strict=True))
    assert not seen["joint.first.densification_stiffness"] and not seen["joint.first.densification_deformation"]
    assert seen["joint.first.elastic_stiffness"] and seen["joint.first.crush_force"]
    assert any("joint.first.densification_stiffness is not seen" in sentence for sentence in found.unseen)


def test_two_recordings_at_once_tell_more_than_either(slow_and_fast):
    both, fast = (run(Sensitivity(), misfit(runs)) for runs in (slow_and_fast, {"fast": slow_and_fast["fast"]}))
    assert both.status is Status.CONVERGED and not both.unseen
    for path, parameter in toys.one_degree().free_parameters().items():
        assert both.values[path] == pytest.approx(parameter.value, rel=1e-6), path
    assert np.all(both.parameters["std"].values < fast.parameters["std"].values)


def test_a_model_with_nothing_free_has_nothing_to_find(slow_and_fast):
    fixed = toys.one_degree()
    fixed = fixed.with_parameters({path: evolve(p, fixed=True) for path, p in fixed.free_parameters().items()})
    found = run(Sensitivity(), Misfit(fixed, slow_and_fast, load().spring_laws, load().observers))
    assert found.values == {} and found.status is Status.CONVERGED


@define
class Corner(Linear):
    """r(u) = 1 + |u - 1|^0.6: past the corner every full step overshoots. Counts what it is asked for."""

    costs: int = 0
    derivatives: int = 0

    def residual(self, scaled):
        self.costs += 1
        return self._residual(scaled)

    def residual_and_jacobian(self, scaled):
        self.derivatives += 1
        slope = 0.6 * np.sign(scaled - 1.0) * np.abs(scaled - 1.0) ** -0.4
        return self._residual(scaled), np.diag(slope)

    def _residual(self, scaled):
        return 1.0 + np.abs(scaled - 1.0) ** 0.6


def test_after_a_refused_step_the_cost_alone_is_asked_for_until_one_is_kept():
    one = [[1.0]], [0.0], [1.01]
    problem = Corner(*(np.array(value) for value in one), *(np.array([end]) for end in (-np.inf, np.inf, False)))
    method = Sensitivity()
    first = method.start(problem)
    after = method.step(problem, first)
    assert after.cost < first.cost
    assert problem.derivatives == 3  # at the start, of the step that was refused, and of the one that was kept
    assert problem.costs > 1
