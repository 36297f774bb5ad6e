"""The contract of identifiers: they recover what is known, within bounds, and can be stopped and resumed."""

import copy
from typing import Any

import numpy as np
import pytest

from crashkit.protocols import Identification, Identifier, Problem, Status
from crashkit.registry import load
from crashkit.testing import toys


class IdentifierContract:
    """Tests of a method of identification; subclass it and give the fixture `identifier`.

    Attributes:
        accuracy: relative error of an identified value that is allowed; there is no noise but rounding.
        start: share of the true values that the search starts from.
        most_steps: after which a search counts as lost.
    """

    accuracy = 1e-4
    start = 0.8
    most_steps = 500

    @pytest.fixture
    def identifier(self) -> Identifier[Any]:
        """The method under test."""
        pytest.fail("an identifier's contract needs a fixture `identifier` that returns an instance")

    @pytest.fixture
    def problem(self) -> toys.MotionProblem:
        """The paper's one degree of freedom, started away from the answer."""
        truth = toys.one_degree()
        return toys.problem(truth, toys.start_from(truth, self.start), load().spring_laws)

    @pytest.fixture
    def two_springs(self) -> toys.MotionProblem:
        """The paper's two degrees of freedom, at two speeds so that every parameter is seen."""
        truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
        return toys.problem(truth, toys.start_from(truth, self.start), load().spring_laws, speeds=(1.0, 1.5))

    def test_recovers_one_degree_of_freedom(self, identifier: Identifier[Any], problem: toys.MotionProblem) -> None:
        self._assert_recovered(self._run(identifier, problem), toys.one_degree().free_parameters())

    def test_recovers_two_degrees_of_freedom(self, identifier: Identifier[Any], two_springs: toys.MotionProblem) -> None:
        truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
        self._assert_recovered(self._run(identifier, two_springs), truth.free_parameters())

    def test_never_leaves_the_bounds(self, identifier: Identifier[Any], problem: toys.MotionProblem) -> None:
        bounded = _Bounded(problem)
        self._run(identifier, bounded)
        lower, upper = bounded.bounds()
        for point in bounded.asked:
            assert np.all((point >= lower) & (point <= upper)), f"a search within bounds asked for {bounded.parameters(point)}"

    def test_a_state_can_be_kept_and_resumed(self, identifier: Identifier[Any], problem: toys.MotionProblem) -> None:
        state = identifier.step(problem, identifier.start(problem))
        kept = copy.deepcopy(state)
        first, second = (identifier.finish(problem, self._search(identifier, problem, s)) for s in (state, kept))
        assert first.values == second.values, "a search resumed from the same state: expected the same result, found another"

    def test_a_step_leaves_a_search_that_has_ended_alone(
        self, identifier: Identifier[Any], problem: toys.MotionProblem
    ) -> None:
        ended = self._search(identifier, problem, identifier.start(problem))
        again = identifier.step(problem, ended)
        before, after = (identifier.finish(problem, state) for state in (ended, again))
        assert (after.status, after.values) == (before.status, before.values), "a step moved a search that had ended"

    def test_a_search_that_is_stopped_says_so(self, identifier: Identifier[Any], problem: toys.MotionProblem) -> None:
        result = identifier.finish(problem, identifier.start(problem))
        assert result.status is not Status.CONVERGED, "stopped before its first step: expected not CONVERGED, found CONVERGED"
        assert set(result.values) == set(problem.names), "the result of a search that is stopped: expected every parameter"

    def _run(self, identifier: Identifier[Any], problem: Problem) -> Identification:
        return identifier.finish(problem, self._search(identifier, problem, identifier.start(problem)))

    def _search(self, identifier: Identifier[Any], problem: Problem, state: Any) -> Any:
        for _ in range(self.most_steps):
            if state.status is not Status.RUNNING:
                return state
            state = identifier.step(problem, state)
        pytest.fail(f"the search still runs after {self.most_steps} steps: expected a status that ends it")

    def _assert_recovered(self, found: Identification, truth: dict[str, Any]) -> None:
        assert found.status is Status.CONVERGED, f"expected CONVERGED, found {found.status.name}: {found.status.value}"
        for path, parameter in truth.items():
            error = abs(found.values[path] / parameter.value - 1.0)
            assert error <= self.accuracy, f"{path}: expected {parameter.value:g}, found {found.values[path]:g}"


class _Bounded:
    """A problem with narrow bounds, one of which keeps the answer out, that remembers which points it was asked for."""

    def __init__(self, problem: toys.MotionProblem) -> None:
        self.problem = problem
        self.names = problem.names
        self.asked: list[np.ndarray] = []

    def start(self) -> np.ndarray:
        return self.problem.start()

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        start = self.start()
        upper = start + 0.3
        upper[0] = start[0] + 0.1
        return start - 0.3, upper

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        self.asked.append(scaled.copy())
        return self.problem.residual(scaled)

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        self.asked.append(scaled.copy())
        return self.problem.residual_and_jacobian(scaled)

    def parameters(self, scaled: np.ndarray) -> np.ndarray:
        return self.problem.parameters(scaled)

    def scaling(self, scaled: np.ndarray) -> np.ndarray:
        return self.problem.scaling(scaled)
