"""Optimal control: the contract, and steps that need the gradient alone."""

import numpy as np
import pytest
import xarray as xr

from crashkit.misfit import Misfit
from crashkit.protocols import Status
from crashkit.registry import load
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.adjoint import cost_and_adjoint, has_adjoint
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
    assert has_adjoint(problem)
    _, gradient = cost_and_adjoint(problem, start)
    for number, direction in enumerate(np.eye(len(start))):
        ahead, behind = (cost_and_adjoint(problem, start + side * 1e-6 * direction)[0] for side in (1.0, -1.0))
        assert gradient[number] == pytest.approx((ahead - behind) / 2e-6, rel=1e-4)


@pytest.mark.parametrize("speeds", [(1.0,), (1.0, 1.5)])
def test_the_adjoint_gives_what_the_sensitivities_give(search, speeds):
    problem = with_gaps(search(toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED), 0.7, speeds, noise=0.01))
    for point in (problem.start(), problem.start() + 0.1):
        (cost, gradient), (own_cost, own) = cost_and_gradient(problem, point), cost_and_adjoint(problem, point)
        assert own_cost == pytest.approx(cost, rel=1e-12)
        assert own == pytest.approx(gradient, rel=1e-7, abs=1e-7 * float(np.abs(gradient).max()))


def with_gaps(problem):
    """The same, some readings of the film not there."""
    runs = {}
    for run_name, tree in problem.recordings.items():
        film = tree["film"].to_dataset(inherit=False)
        film["position"] = film["position"].where(xr.DataArray(np.arange(film.sizes["time"]) % 7 > 0, dims="time"))
        runs[run_name] = tree.assign(film=xr.DataTree(film))
    return Misfit(problem.model, runs, load().spring_laws, load().observers)


def test_a_filtered_instrument_has_no_adjoint(search):
    clean = search(toys.one_degree())
    tree = clean.recordings["speed_1"]
    tree = tree.assign(accelerometer=xr.DataTree(tree["accelerometer"].to_dataset(inherit=False)))
    tree["accelerometer"].attrs["channel_frequency_class"] = 60
    problem = Misfit(clean.model, {"speed_1": tree}, load().spring_laws, load().observers)
    assert has_adjoint(clean) and not has_adjoint(problem)


def test_many_parameters_take_the_adjoint_and_end_in_the_same_place(search, monkeypatch):
    problem, asked = search(toys.one_degree()), []
    few = run(OptimalControl(step_limit=5), problem)
    monkeypatch.setattr("crashkit_identifiers.adjoint.MANY", 4)
    monkeypatch.setattr("crashkit_identifiers.adjoint.cost_and_adjoint", lambda *a: asked.append(a) or cost_and_adjoint(*a))
    many = run(OptimalControl(step_limit=5), problem)
    assert asked and many.parameters["value"].values == pytest.approx(few.parameters["value"].values, rel=1e-6)


def test_it_finds_what_the_sensitivity_method_finds(search):
    problem = search(toys.one_degree(), noise=0.03)
    control, sensitivity = (run(method, problem) for method in (OptimalControl(), Sensitivity()))
    assert control.status is Status.CONVERGED
    assert control.cost == pytest.approx(sensitivity.cost, rel=1e-6)
    assert control.parameters["value"].values == pytest.approx(sensitivity.parameters["value"].values, rel=1e-3)
    assert control.parameters["std"].values == pytest.approx(sensitivity.parameters["std"].values, rel=0.05)


def test_a_search_that_runs_out_of_steps_says_so(search):
    assert run(OptimalControl(step_limit=3), search(toys.one_degree())).status is Status.STEP_LIMIT
