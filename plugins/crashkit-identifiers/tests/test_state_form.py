"""The state form as a method: the contract, and that it hardly needs a start."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.misfit import Misfit
from crashkit.model import GivenForce
from crashkit.protocols import Status
from crashkit.registry import load
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity
from crashkit_identifiers.state_form import FEW, LONGER, QuickRegression, StateFormRegression


class TestStateForm(IdentifierContract):
    accuracy = 1e-3

    @pytest.fixture
    def identifier(self):
        return StateFormRegression()


class TestQuickRegression(IdentifierContract):
    accuracy = 1e-2

    @pytest.fixture
    def identifier(self):
        return QuickRegression()


def test_a_quick_start_looks_at_few_instants(search):
    problem = search(toys.one_degree())
    state = QuickRegression().start(problem)
    assert problem.step < state.measured.step <= LONGER * problem.step
    assert {run: FEW <= motion.sizes["time"] < 2 * FEW for run, motion in state.measured.by_run.items()} == {"speed_1": True}


def test_a_problem_without_a_free_number_is_begun(search):
    """What it leaves of the equations of motion is still worth knowing."""
    problem = search(toys.one_degree())
    known = problem.with_values({}, free=dict.fromkeys(problem.names, False))
    state = QuickRegression().start(known)
    assert known.names == () and state.point.shape == (0,)
    assert np.isfinite(state.cost)


@pytest.mark.parametrize("factor", [0.3, 3.0])
def test_a_start_that_is_far_off_does_not_matter(search, errors, factor):
    truth = toys.one_degree()
    found = run(StateFormRegression(), search(truth, factor))
    assert found.status is Status.CONVERGED
    assert max(map(abs, errors(found, truth).values())) < 1e-3


def test_it_starts_a_method_that_simulates(search, errors):
    truth = toys.one_degree()
    problem = search(truth, 3.0)
    alone = run(Sensitivity(), problem)
    helped = run(Sensitivity(), problem.with_values(run(StateFormRegression(), problem).values))
    assert alone.parameters.normalised_residual > 1.0
    assert max(map(abs, errors(helped, truth).values())) < 1e-5


@pytest.fixture
def blind(search):
    """A problem in which nobody sees the rear body."""

    def of(truth, factor=1.0):
        recording = search(truth).recordings["speed_1"]
        front = {
            name: xr.DataTree(recording[name].to_dataset().isel({channel: [0]}))
            for name, channel in (("film", "marker"), ("accelerometer", "sensor"))
        }
        registry = load()
        given = toys.start_from(truth, factor)
        return Misfit(given, {"run": recording.assign(front)}, registry.spring_laws, registry.observers)

    return of


@pytest.mark.parametrize("factor", [0.3, 3.0])
def test_a_body_that_nobody_saw_is_simulated_beside_the_others(blind, errors, factor):
    truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    found = run(StateFormRegression(), blind(truth, factor))
    assert "body.rear.mass" in found.values
    assert max(map(abs, errors(found, truth).values())) < 1e-3


@pytest.mark.parametrize("seen", ["all", "front"])
def test_residuals_alone_are_those_that_come_with_derivatives(search, blind, seen):
    given = search if seen == "all" else blind
    problem = given(toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED), 1.3)
    state = StateFormRegression().start(problem)
    equations = StateFormRegression().equations(problem, state)
    np.testing.assert_array_equal(equations.residual(state.point), equations.residual_and_jacobian(state.point)[0])


def test_a_body_that_nobody_saw_is_named_where_a_force_is_given(blind):
    truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    pushed = evolve(truth.bodies[1], force=GivenForce((0.0, 0.2), ((0.0,), (5000.0,))))
    truth = evolve(truth, bodies=(truth.bodies[0], pushed, *truth.bodies[2:]))
    expected = "run: state_form needs the measured motion of every body .* found none of rear"
    with pytest.raises(CrashkitError, match=expected):
        StateFormRegression().start(blind(truth))


def test_a_problem_without_recordings_is_refused():
    with pytest.raises(CrashkitError, match="state_form: expected a misfit of a model to recordings, found object"):
        StateFormRegression().start(object())
