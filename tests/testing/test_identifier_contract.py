"""The contract of identifiers: a method from a library passes it, and each fault is found."""

from typing import ClassVar

import numpy as np
import pytest
import xarray as xr
from attrs import evolve, frozen
from scipy.optimize import least_squares

from crashkit.protocols import Identification, Identifier, Status
from crashkit.registry import load
from crashkit.testing import IdentifierContract, toys


@frozen
class State:
    point: np.ndarray
    status: Status


class Reference(Identifier[State]):
    """scipy's trust-region reflective method, all of it in one step."""

    name: ClassVar[str] = "reference"

    def start(self, problem):
        return State(problem.start(), Status.RUNNING)

    def step(self, problem, state):
        if state.status is not Status.RUNNING:
            return state
        jacobian = lambda point: problem.residual_and_jacobian(point)[1]  # noqa: E731
        tolerance = {"xtol": 1e-14, "ftol": 1e-14, "gtol": 1e-14}
        found = least_squares(problem.residual, state.point, jacobian, problem.bounds(), x_scale="jac", **tolerance)
        return State(found.x, Status.CONVERGED)

    def finish(self, problem, state):
        values, names = problem.parameters(state.point), list(problem.names)
        residual, jacobian = problem.residual_and_jacobian(state.point)
        covariance = np.linalg.pinv(jacobian.T @ jacobian) * np.outer(values, values)
        std = np.sqrt(np.diag(covariance))
        lower, upper = (problem.parameters(bound) for bound in problem.bounds())
        columns = {
            "value": values,
            "std": std,
            "interval_lower": values - 2.0 * std,
            "interval_upper": values + 2.0 * std,
            "lower": lower,
            "upper": upper,
            "at_bound": (values <= lower) | (values >= upper),
            "identifiable": std < values,
            "units": np.full(len(names), ""),
        }
        table = xr.Dataset(
            {name: ("parameter", column) for name, column in columns.items()}
            | {"covariance": (("parameter", "parameter_2"), covariance)},
            {"parameter": names, "parameter_2": names},
        )
        path = xr.Dataset({"cost": ("step", [0.5 * residual @ residual])})
        return Identification(table, state.status, 0.0, path=path)


class TestReference(IdentifierContract):
    @pytest.fixture
    def identifier(self):
        return Reference()


class GivesUp(Reference):
    """Calls the start the answer."""

    def step(self, problem, state):
        return evolve(state, status=Status.CONVERGED)


class Halfway(Reference):
    """Stops on the way to the answer, and calls that the answer."""

    def step(self, problem, state):
        return State(0.5 * (state.point + super().step(problem, state).point), Status.CONVERGED)


class NeverEnds(Reference):
    def step(self, problem, state):
        return state


class Boundless(Reference):
    def step(self, problem, state):
        problem.residual(state.point + 1.0)
        return evolve(state, status=Status.CONVERGED)


class Restless(Reference):
    """Moves on after the end."""

    def step(self, problem, state):
        return State(state.point + 0.01, Status.CONVERGED)


class Forgetful(Reference):
    """Keeps its progress outside its state."""

    steps = 0

    def step(self, problem, state):
        if state.status is not Status.RUNNING:
            return state
        self.steps += 1
        return State(state.point + 0.01 * self.steps, Status.CONVERGED if self.steps > 1 else Status.RUNNING)


class Boastful(Reference):
    def start(self, problem):
        return State(problem.start(), Status.CONVERGED)


class Bare(Reference):
    """Says no more than the values."""

    def finish(self, problem, state):
        whole = super().finish(problem, state)
        return evolve(whole, parameters=whole.parameters[["value"]])


class Overconfident(Reference):
    """Is a little off, and sure of it."""

    def finish(self, problem, state):
        whole = super().finish(problem, state)
        return evolve(whole, parameters=whole.parameters.assign(std=1e-6 * whole.parameters["value"]))


@pytest.fixture(scope="module")
def problem():
    truth, registry = toys.one_degree(), load()
    return toys.problem(truth, toys.start_from(truth, 0.8), registry.spring_laws, registry.observers)


FAULTS = [
    ("test_recovers_one_degree_of_freedom", GivesUp, "joint.first.elastic_stiffness: expected 120000, found 96000"),
    ("test_never_leaves_the_bounds", Boundless, "a search within bounds asked for"),
    ("test_a_step_leaves_a_search_that_has_ended_alone", Restless, "a step moved a search that had ended"),
    ("test_a_state_can_be_kept_and_resumed", Forgetful, "expected the same result, found another"),
    ("test_a_search_that_is_stopped_says_so", Boastful, "expected not CONVERGED, found CONVERGED"),
    ("test_a_result_is_complete", Bare, "found none of at_bound, identifiable"),
    ("test_with_noise_it_claims_no_more_than_it_knows", Overconfident, "within 4 of its standard deviation"),
]


@pytest.mark.parametrize(("test", "faulty", "message"), FAULTS, ids=[row[1].__name__ for row in FAULTS])
def test_a_fault_is_found(problem, test, faulty, message):
    with pytest.raises(AssertionError, match=message):
        getattr(IdentifierContract(), test)(faulty(), problem)


class OnlyHonest(IdentifierContract):
    recovers = ()


def test_of_a_toy_that_is_not_declared_a_lower_cost_and_honesty_are_asked(problem):
    OnlyHonest().test_recovers_one_degree_of_freedom(Reference(), problem)
    with pytest.raises(AssertionError, match="expected a cost below that of the start"):
        OnlyHonest().test_recovers_one_degree_of_freedom(GivesUp(), problem)
    with pytest.raises(AssertionError, match="within 4 of its standard deviation"):
        OnlyHonest().test_recovers_one_degree_of_freedom(Halfway(), problem)


def test_a_search_without_end_is_found(problem):
    with pytest.raises(pytest.fail.Exception, match="the search still runs after 500 steps"):
        IdentifierContract().test_recovers_one_degree_of_freedom(NeverEnds(), problem)
