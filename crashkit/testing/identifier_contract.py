"""The contract of identifiers: they recover what they declare, claim no more than they know, can be stopped and resumed."""

import copy
from typing import Any

import numpy as np
import pytest

from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit.registry import load
from crashkit.testing import toys

COLUMNS = {"value", "std", "interval_lower", "interval_upper", "lower", "upper", "at_bound", "identifiable", "units"}
NOISE = 0.01
"""Of the noisy toy, as a share of each channel's range."""
FURTHER = 3
"""Steps after which a search and its resumed copy are compared."""
SURE = 4.0
"""Standard deviations that a true value is never away from what was found."""


class IdentifierContract:
    """Tests of a method of identification; subclass it and give the fixture `identifier`.

    Attributes:
        recovers: the toys that the method finds from `start`: "one_degree", "two_degrees"; of any other it must lower the cost
            and be honest.
        accuracy: relative error of an identified value that is allowed; there is no noise but rounding.
        start: share of the true values that the search starts from.
        most_steps: after which a search counts as lost.
    """

    recovers: tuple[str, ...] = ("one_degree", "two_degrees")
    accuracy = 1e-4
    start = 0.8
    most_steps = 500

    @pytest.fixture
    def identifier(self) -> Identifier[Any]:
        """The method under test."""
        pytest.fail("an identifier's contract needs a fixture `identifier` that returns an instance")

    @pytest.fixture
    def problem(self) -> Misfit:
        """The paper's one degree of freedom, started away from the answer."""
        return self._problem(toys.one_degree(), (1.0,))

    @pytest.fixture
    def two_springs(self) -> Misfit:
        """The paper's two degrees of freedom, at two speeds so that every parameter is seen."""
        return self._problem(toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED), (1.0, 1.5))

    def test_recovers_one_degree_of_freedom(self, identifier: Identifier[Any], problem: Misfit) -> None:
        self._assert_found("one_degree", identifier, problem, toys.one_degree())

    def test_recovers_two_degrees_of_freedom(self, identifier: Identifier[Any], two_springs: Misfit) -> None:
        truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
        self._assert_found("two_degrees", identifier, two_springs, truth)

    def test_with_noise_it_claims_no_more_than_it_knows(self, identifier: Identifier[Any], problem: Misfit) -> None:
        random, registry = np.random.default_rng(0), load()
        noisy = {run: toys.noisy(tree, NOISE, random) for run, tree in problem.recordings.items()}
        found = self._run(identifier, Misfit(problem.model, noisy, registry.spring_laws, registry.observers))
        self._assert_honest(found, toys.one_degree())

    def test_never_leaves_the_bounds(self, identifier: Identifier[Any], problem: Misfit) -> None:
        bounded = _Bounded(problem)
        self._run(identifier, bounded)
        lower, upper = bounded.bounds()
        for point in bounded.asked:
            assert np.all((point >= lower) & (point <= upper)), f"a search within bounds asked for {bounded.parameters(point)}"

    def test_a_state_can_be_kept_and_resumed(self, identifier: Identifier[Any], problem: Misfit) -> None:
        state = identifier.step(problem, identifier.start(problem))
        kept = copy.deepcopy(state)
        for _ in range(FURTHER):
            state = identifier.step(problem, state)
        for _ in range(FURTHER):
            kept = identifier.step(problem, kept)
        first, second = (identifier.finish(problem, end) for end in (state, kept))
        assert first.values == second.values, "a search resumed from the same state: expected the same result, found another"

    def test_a_step_leaves_a_search_that_has_ended_alone(self, identifier: Identifier[Any], problem: Misfit) -> None:
        ended = self._search(identifier, problem, identifier.start(problem))
        again = identifier.step(problem, ended)
        before, after = (identifier.finish(problem, state) for state in (ended, again))
        assert (after.status, after.values) == (before.status, before.values), "a step moved a search that had ended"

    def test_a_search_that_is_stopped_says_so(self, identifier: Identifier[Any], problem: Misfit) -> None:
        result = identifier.finish(problem, identifier.start(problem))
        assert result.status is not Status.CONVERGED, "stopped before its first step: expected not CONVERGED, found CONVERGED"
        assert set(result.values) == set(problem.names), "the result of a search that is stopped: expected every parameter"

    def test_a_result_is_complete(self, identifier: Identifier[Any], problem: Misfit) -> None:
        found = self._run(identifier, problem)
        missing = COLUMNS - set(found.parameters.data_vars)
        assert not missing, f"a result: expected {', '.join(sorted(COLUMNS))}, found none of {', '.join(sorted(missing))}"
        assert found.parameters["covariance"].dims == ("parameter", "parameter_2"), "a result: expected a covariance"
        assert found.path is not None and found.path.sizes["step"] > 0, "a result: expected the path that the search took"
        low, value, high = (found.parameters[name].values for name in ("interval_lower", "value", "interval_upper"))
        assert np.all((low <= value) & (value <= high)), "a result: expected values within their intervals"

    def _problem(self, truth: Model, speeds: tuple[float, ...]) -> Misfit:
        registry = load()
        start = toys.start_from(truth, self.start)
        return toys.problem(truth, start, registry.spring_laws, registry.observers, speeds)

    def _run(self, identifier: Identifier[Any], problem: Problem) -> Identification:
        return identifier.finish(problem, self._search(identifier, problem, identifier.start(problem)))

    def _search(self, identifier: Identifier[Any], problem: Problem, state: Any) -> Any:
        for _ in range(self.most_steps):
            if state.status is not Status.RUNNING:
                return state
            state = identifier.step(problem, state)
        pytest.fail(f"the search still runs after {self.most_steps} steps: expected a status that ends it")

    def _assert_found(self, toy: str, identifier: Identifier[Any], problem: Misfit, truth: Model) -> None:
        found = self._run(identifier, problem)
        if toy not in self.recovers:
            before, after = (_cost(problem, point) for point in (problem.start(), problem.start_at(found.values)))
            assert after < before, f"expected a cost below that of the start, {before:g}, found {after:g}"
            self._assert_honest(found, truth)
            return
        assert found.status is Status.CONVERGED, f"expected CONVERGED, found {found.status.name}: {found.status.value}"
        for path, parameter in truth.free_parameters().items():
            error = abs(found.values[path] / parameter.value - 1.0)
            assert error <= self.accuracy, f"{path}: expected {parameter.value:g}, found {found.values[path]:g}"

    def _assert_honest(self, found: Identification, truth: Model) -> None:
        """What is said to be known is true; a search that says it has not converged may be anywhere."""
        if found.status is not Status.CONVERGED:
            return
        for path, parameter in truth.free_parameters().items():
            row = found.parameters.sel(parameter=path)
            away = abs(float(row["value"]) - parameter.value)
            claimed = bool(row["identifiable"]) and np.isfinite(float(row["std"]))
            assert not claimed or away <= SURE * float(row["std"]), (
                f"{path}: expected {parameter.value:g} within {SURE:g} of its standard deviation {float(row['std']):.2g}, "
                f"found {float(row['value']):g}"
            )


def _cost(problem: Misfit, point: np.ndarray) -> float:
    residual = problem.residual(point)
    return 0.5 * float(residual @ residual)


class _Bounded(Misfit):
    """A problem with narrow bounds, one of which keeps the answer out, that remembers which points it was asked for."""

    def __init__(self, problem: Misfit) -> None:
        registry = load()
        super().__init__(problem.model, problem.recordings, registry.spring_laws, registry.observers)
        self.asked: list[np.ndarray] = []

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        start = self.start()
        upper = start + 0.3
        upper[0] = start[0] + 0.1
        return start - 0.3, upper

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        self.asked.append(scaled.copy())
        return super().residual(scaled)

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        self.asked.append(scaled.copy())
        return super().residual_and_jacobian(scaled)
