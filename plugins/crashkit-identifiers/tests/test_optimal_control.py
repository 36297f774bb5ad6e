"""Optimal control: the contract, and steps that need the gradient alone."""

import numpy as np
import pytest

from crashkit.protocols import Status
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.cost import cost_and_gradient
from crashkit_identifiers.optimal_control import OptimalControl
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity


class TestOptimalControl(IdentifierContract):
    @pytest.fixture
    def identifier(self):
        return OptimalControl()


def test_the_gradient_is_that_of_differences(search):
    problem = search(toys.one_degree())
    start = problem.start()
    _, gradient = cost_and_gradient(problem, start)
    for number, direction in enumerate(np.eye(len(start))):
        ahead, behind = (cost_and_gradient(problem, start + side * 1e-6 * direction)[0] for side in (1.0, -1.0))
        assert gradient[number] == pytest.approx((ahead - behind) / 2e-6, rel=1e-4)


def test_it_finds_what_the_sensitivity_method_finds(search):
    problem = search(toys.one_degree(), noise=0.03)
    control, sensitivity = (run(method, problem) for method in (OptimalControl(), Sensitivity()))
    assert control.status is Status.CONVERGED
    assert control.cost == pytest.approx(sensitivity.cost, rel=1e-6)
    assert control.parameters["value"].values == pytest.approx(sensitivity.parameters["value"].values, rel=1e-3)
    assert control.parameters["std"].values == pytest.approx(sensitivity.parameters["std"].values, rel=0.05)


def test_a_search_that_runs_out_of_steps_says_so(search):
    assert run(OptimalControl(step_limit=3), search(toys.one_degree())).status is Status.STEP_LIMIT
