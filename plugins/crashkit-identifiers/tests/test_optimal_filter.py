"""The optimal least-squares filter: the contract, and its equation of motion against the engine."""

import numpy as np
import pytest

from crashkit.errors import CrashkitError
from crashkit.model import Body, Model, Parameter
from crashkit.protocols import Status
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.line_dynamics import LineDynamics
from crashkit_identifiers.measured import measured_motion
from crashkit_identifiers.optimal_filter import OptimalFilter
from crashkit_identifiers.run import run


class TestOptimalFilter(IdentifierContract):
    accuracy = 1e-3

    @pytest.fixture
    def identifier(self):
        return OptimalFilter()


@pytest.fixture
def dynamics(search):
    problem = search(toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED), factor=1.0, speeds=(1.5,))
    return problem, LineDynamics(problem, measured_motion(problem, "speed_1.5"))


def test_its_equation_of_motion_is_the_engine_s(dynamics):
    problem, line = dynamics
    motion = problem.predictor.motion("speed_1.5", problem.values(problem.start()))
    expected = motion.sel(body=["front", "rear"]).isel(axis=0)
    state = np.concatenate([expected[name].values[0] for name in ("position", "velocity")])
    for step in np.diff(motion["time"].values):
        state, _ = line.advance(state, problem.start(), float(step))
    assert state[:2] == pytest.approx(expected["position"].values[-1], abs=1e-5)
    assert state[2:] == pytest.approx(expected["velocity"].values[-1], abs=1e-3)


def test_its_transition_is_that_of_differences(dynamics):
    problem, line = dynamics
    state, point = np.array([-4.7, -9.55, 8.0, 9.0]), problem.start()
    _, transition = line.advance(state, point, 1e-3)
    both = np.concatenate([state, point])
    for number, direction in enumerate(np.eye(len(both))):
        ahead, behind = both + 1e-6 * direction, both - 1e-6 * direction
        change = (line.advance(ahead[:4], ahead[4:], 1e-3)[0] - line.advance(behind[:4], behind[4:], 1e-3)[0]) / 2e-6
        np.testing.assert_allclose(transition[:4, number], change, rtol=1e-5, atol=1e-8)


def test_one_pass_is_not_enough(search):
    assert run(OptimalFilter(passes=1), search(toys.one_degree())).status is Status.STEP_LIMIT


def test_a_plane_is_refused(search):
    problem = search(toys.one_degree())
    bodies = (Body("wall", (0.0, 0.0), (0.0, 0.0), fixed=True), Body("car", (1.0, 0.0), (0.0, 0.0), Parameter(1.0)))
    problem.model = Model("plane", ("x", "y"), bodies, ())
    with pytest.raises(CrashkitError, match="optimal_filter: expected a model in one axis, found x, y"):
        OptimalFilter().start(problem)
