"""The toys are the paper's models: beside its own non-dimensional equations, integrated by scipy."""

import numpy as np
import pytest
from attrs import astuple
from scipy.integrate import solve_ivp

from crashkit.data import check_recording
from crashkit.mechanics import Simulator
from crashkit.registry import load
from crashkit.testing import toys

TIMES = np.linspace(0.0, 6.0, 61)


def spring(x: float) -> float:
    """F(x) with alpha = beta = 1.2, gamma = 0.6, delta = 0.24 (eq 40)."""
    return 0.0 if x < 0 else 1.2 * x if x < 0.2 else 0.24 if x < 0.6 else 0.24 + 1.2 * (x - 0.6)


def one_degree(t: float, state: np.ndarray) -> list[float]:
    x, v = state
    return [v, -spring(x)]


def two_degrees(rho: float, ratio: float):
    """Eq 66 and 67, with `ratio` = m' / m."""

    def slope(t: float, state: np.ndarray) -> list[float]:
        x1, x2, v1, v2 = state
        second = spring(x2 - x1)
        return [v1, v2, -spring(x1) + rho * ratio * second, -rho * second]

    return slope


def solved(slope, speeds: list[float]) -> np.ndarray:
    start = [0.0] * len(speeds) + speeds
    path = solve_ivp(slope, (0.0, TIMES[-1]), start, method="DOP853", t_eval=TIMES, rtol=1e-10, atol=1e-12, max_step=0.01)
    return path.y[: len(speeds)]


def simulated(model, speed: float) -> np.ndarray:
    """Displacements in the paper's units, a row for each body that moves."""
    motion = Simulator(model, load().spring_laws).run(TIMES * 0.1, initial=toys.initial_state(model, speed))
    moving = motion["position"].isel(axis=0).sel(body=[body.name for body in model.bodies if not body.fixed])
    return (moving - moving.isel(time=0)).transpose("body", "time").values


@pytest.mark.parametrize("speed", [1.0, 1.5, 2.0])
def test_one_degree_of_freedom(speed):
    np.testing.assert_allclose(simulated(toys.one_degree(), speed), solved(one_degree, [speed]), atol=1e-7)


@pytest.mark.parametrize("speed", [1.0, 2.0])
@pytest.mark.parametrize("rear_mass", [toys.REAR_MASS_AS_PRINTED, toys.REAR_MASS_INVERTED])
def test_two_degrees_of_freedom(speed, rear_mass):
    expected = solved(two_degrees(2.4, rear_mass), [speed, speed])
    np.testing.assert_allclose(simulated(toys.two_degrees(rear_mass=rear_mass), speed), expected, atol=1e-7)


def test_the_paper_s_nominal_speed_is_the_models_own():
    assert toys.one_degree(1.5).body("front").velocity == (15.0,)
    assert toys.two_degrees(2.0).body("rear").velocity == (20.0,)


@pytest.mark.parametrize(("rear_mass", "passes"), [(toys.REAR_MASS_AS_PRINTED, False), (toys.REAR_MASS_INVERTED, True)])
def test_the_second_spring_passes_its_plateau_at_speed_1_only_before_the_smaller_mass(rear_mass, passes):
    front, rear = simulated(toys.two_degrees(rear_mass=rear_mass), 1.0)
    assert ((rear - front).max() > toys.REFERENCE.gamma) == passes


def test_a_start_moves_every_free_parameter():
    truth = toys.two_degrees()
    start = toys.start_from(truth, 0.8)
    for path, parameter in truth.free_parameters().items():
        assert start.parameters()[path].value == pytest.approx(0.8 * parameter.value)
    assert start.body("front").mass == truth.body("front").mass


def problem(truth, start, speeds=(1.0,), exact=False):
    registry = load()
    return toys.problem(truth, start, registry.spring_laws, registry.observers, speeds, exact)


def test_the_problem_is_solved_by_the_truth_but_for_rounding():
    truth = toys.two_degrees()
    rounded, exact = (problem(truth, truth, (1.0, 2.0), exact=e).with_step(1e-4) for e in (False, True))
    largest = np.abs(rounded.residual(rounded.start())).max()
    assert 0.3e-3 < largest <= 0.501e-3
    assert np.abs(exact.residual(exact.start())).max() < 1e-6


def test_the_problem_s_jacobian_is_that_of_differences():
    truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    search = problem(truth, toys.start_from(truth, 0.9))
    start = search.start()
    residual, jacobian = search.residual_and_jacobian(start)
    np.testing.assert_array_equal(residual, search.residual(start))
    for column, direction in enumerate(np.eye(start.size)):
        difference = (search.residual(start + 1e-6 * direction) - search.residual(start - 1e-6 * direction)) / 2e-6
        np.testing.assert_allclose(jacobian[:, column], difference, atol=1e-4 * np.abs(jacobian).max())


def test_the_parameters_of_a_spring_are_the_paper_s():
    own = toys.Spring(0.9, 1.1, 0.5, 0.2)
    model = toys.two_degrees(rear_mass=0.7, first=own, second=toys.REFERENCE, rho=2.0)
    assert astuple(toys.spring_of(model, "first")) == pytest.approx(astuple(own))
    assert astuple(toys.spring_of(model, "second", stiffness=2.0 * 0.7)) == pytest.approx(astuple(toys.REFERENCE))


def test_the_paper_s_ten_parameters_move_like_the_nine():
    nine = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    ten = toys.with_ten_parameters(nine)
    laws = {**load().spring_laws, "stiffness_ratio": toys.StiffnessRatio}
    assert len(ten.free_parameters()) == 10 and len(nine.free_parameters()) == 9
    motions = [Simulator(model, laws).run(TIMES * 0.1, initial=toys.initial_state(model, 1.5)) for model in (nine, ten)]
    np.testing.assert_allclose(motions[0]["position"], motions[1]["position"], atol=1e-9)


def test_noise_is_as_large_as_it_says():
    model = toys.one_degree()
    motion = Simulator(model, load().spring_laws).run(toys.TIMES)
    clean = toys.recording(motion)
    noisy = toys.noisy(clean, 0.03, np.random.default_rng(0))
    for name, quantity in (("film", "position"), ("accelerometer", "acceleration")):
        before, after = (tree[name].to_dataset() for tree in (clean, noisy))
        std = float(after[f"{quantity}_std"].values[0])
        assert std == pytest.approx(0.03 * np.ptp(before[quantity].values))
        assert np.std(after[quantity].values - before[quantity].values) == pytest.approx(std, rel=0.1)
    check_recording(noisy, {name: observer.schema for name, observer in load().observers.items()}, "toy")


def test_a_recording_keeps_the_data_contract_and_holds_the_motion():
    model = toys.one_degree()
    motion = Simulator(model, load().spring_laws).run(np.linspace(0.0, 0.2, 21))
    tree = toys.recording(motion)
    check_recording(tree, {name: observer.schema for name, observer in load().observers.items()}, "toy")
    film = tree["film"].to_dataset()
    assert film["marker_body"].values.tolist() == ["front"]
    np.testing.assert_array_equal(film["position"].values[:, 0, 0], motion["position"].sel(body="front", axis="x").values)
