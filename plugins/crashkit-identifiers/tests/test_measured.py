"""The measured motion: one spline through film and accelerometers, in one axis and in several."""

import numpy as np
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

from crashkit.misfit import Misfit
from crashkit.model import Body
from crashkit.registry import load
from crashkit.testing import toys
from crashkit_identifiers.measured import measured_motion
from crashkit_identifiers.measured_rotation import rotation_curves
from crashkit_identifiers.spline import Reading, enough, smoothed

QUANTITIES = ("position", "velocity", "acceleration")


def deviations(problem, truth, speed):
    """Root mean square errors of what was measured, and what they are said to be, of the moving bodies."""
    measured = measured_motion(problem, f"speed_{speed:g}")
    true = problem.with_values({p: q.value for p, q in truth.free_parameters().items()}).predictor
    motion = true.motion(f"speed_{speed:g}", {p: q.value for p, q in truth.free_parameters().items()})
    found = {}
    for name in QUANTITIES:
        away = (measured[name] - motion[name]).sel(body=["front", "rear"])
        found[name] = float(np.sqrt((away**2).mean())), float(measured[f"{name}_std"].sel(body=["front", "rear"]).mean())
    return found


def test_without_noise_the_motion_is_measured(search):
    truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    found = deviations(search(truth, speeds=(1.5,)), truth, 1.5)
    assert found["position"][0] < 1e-6
    assert found["velocity"][0] < 1e-4
    assert found["acceleration"][0] < 0.1  # of 100 m s-2, at the corners


@pytest.mark.parametrize("noise", [0.01, 0.1])
def test_with_noise_the_errors_are_as_large_as_they_are_said_to_be(search, noise):
    truth = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
    for name, (error, stated) in deviations(search(truth, noise=noise), truth, 1.0).items():
        assert 0.3 * stated < error < 2.5 * stated, name


def test_film_and_accelerometers_together_tell_more_than_film(search):
    truth, registry = toys.one_degree(), load()
    problem = search(truth, noise=0.03)
    tree = problem.recordings["speed_1"]
    film_only = xr.DataTree(children={name: tree[name].copy() for name in ("film", "initial")})
    alone = Misfit(truth, {"speed_1": film_only}, registry.spring_laws, registry.observers)
    stds = [float(measured_motion(one, "speed_1")["acceleration_std"].sel(body="front").mean()) for one in (problem, alone)]
    assert stds[0] < 0.5 * stds[1]


def test_a_fixed_body_stays_and_an_unseen_one_is_not_known(search):
    truth, registry = toys.two_degrees(), load()
    tree = search(truth).recordings["speed_1"]
    film = tree["film"].to_dataset().isel(marker=[0])
    blind = xr.DataTree(children={"film": xr.DataTree(film), "initial": tree["initial"].copy()})
    measured = measured_motion(Misfit(truth, {"run": blind}, registry.spring_laws, registry.observers), "run")
    assert measured["seen"].to_series().to_dict() == {"wall": True, "front": True, "rear": False}
    assert not measured["velocity"].sel(body="wall").values.any()
    assert measured["position"].sel(body="rear").isnull().all()


def test_a_spline_follows_a_polynomial_through_readings_of_its_derivatives():
    times = np.linspace(0.0, 1.0, 41)
    curve = np.polynomial.Polynomial([1.0, -2.0, 3.0])
    readings = [Reading(0, times[:1], curve(times[:1]), 1e-3), Reading(1, times[:1], curve.deriv()(times[:1]), 1e-3)]
    readings.append(Reading(2, times, curve.deriv(2)(times), 1.0))
    for order, (values, _) in enumerate(smoothed(readings, times)):
        np.testing.assert_allclose(values, curve.deriv(order)(times) if order else curve(times), atol=1e-6)


def test_a_rotation_about_a_moving_axis_has_its_angular_velocity():
    """R = exp(z θ) exp(x φ): ω = θ' z + φ' R_z x."""
    times = np.linspace(0.0, 0.2, 401)
    theta, phi = 2.0 * times, 5.0 * times**2
    turn = Rotation.from_rotvec(np.outer(theta, [0, 0, 1])) * Rotation.from_rotvec(np.outer(phi, [1, 0, 0]))
    x_axis = np.column_stack([np.cos(theta), np.sin(theta), 0.0 * theta])
    spin = np.column_stack([0.0 * theta, 0.0 * theta, 2.0 + 0.0 * theta]) + 10.0 * times[:, None] * x_axis
    change = 10.0 * x_axis + 20.0 * times[:, None] * np.column_stack([-np.sin(theta), np.cos(theta), 0.0 * theta])
    body = Body("car", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    found = rotation_curves([(times, turn.as_quat(scalar_first=True))], times, body, ("x", "y", "z"))
    np.testing.assert_allclose(found["angular_velocity"], spin, atol=1e-4)
    np.testing.assert_allclose(found["angular_acceleration"][5:-5], change[5:-5], atol=0.05)
    assert (Rotation.from_quat(found["orientation"], scalar_first=True) * turn.inv()).magnitude().max() < 1e-6


def test_a_body_whose_turning_nobody_saw_is_not_known():
    body = Body("car", (0.0, 0.0), (0.0, 0.0))
    found = rotation_curves([], np.linspace(0.0, 0.1, 11), body, ("x", "y"))
    assert all(np.isnan(values).all() for values in found.values())


def test_a_short_test_of_light_bodies_has_a_motion_too():
    """Second derivatives over 5 ms beside a start that is known to 10 µm: their squares are twenty orders apart."""
    times = np.linspace(0.0, 5e-3, 301)
    accelerated = Reading(2, times, 500.0 * np.sin(2e3 * times), 1e-3)
    known = [Reading(0, np.zeros(1), np.zeros(1), 1e-5), Reading(1, np.zeros(1), np.full(1, -0.25), 1e-4)]
    (position, _), *_ = smoothed([accelerated, *known], times)
    assert position == pytest.approx(-1.25e-4 * np.sin(2e3 * times), abs=5e-6)


def test_accelerations_alone_are_no_motion():
    times = np.linspace(0.0, 0.1, 101)
    accelerated, start = Reading(2, times, times, 1.0), Reading(0, np.zeros(1), np.zeros(1), 1e-5)
    speed = Reading(1, np.zeros(1), np.zeros(1), 1e-4)
    assert [enough(some) for some in ([accelerated], [accelerated, start], [accelerated, start, speed])] == [
        False,
        False,
        True,
    ]


def test_many_models_share_what_was_measured(search, monkeypatch):
    problem = search(toys.one_degree())
    first = measured_motion(problem, "speed_1")
    monkeypatch.setattr("crashkit_identifiers.measured.smoothed", lambda *_: pytest.fail("smoothed again"))
    again = measured_motion(problem.with_values({"joint.first.crush_force": 1e4}), "speed_1")
    xr.testing.assert_identical(first, again)
