"""Bortz's rotation vector against quaternions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from crashkit_accelerometers.orientation import bortz_rate, orientations

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def coning(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rates whose direction turns, so that the order of small rotations matters, and their derivatives."""
    w = 60.0
    omega = np.stack([20 * np.cos(w * times), 15 * np.sin(w * times), 5 + 8 * np.sin(2 * w * times)], axis=1)
    alpha = w * np.stack([-20 * np.sin(w * times), 15 * np.cos(w * times), 16 * np.cos(2 * w * times)], axis=1)
    return omega, alpha


def by_quaternion(times: np.ndarray) -> Rotation:
    """q' = q (0, omega) / 2, to 1e-12."""

    def rate(time: float, q: np.ndarray) -> np.ndarray:
        x, y, z = coning(np.array([time]))[0][0]
        matrix = np.array([[0, -x, -y, -z], [x, 0, z, -y], [y, -z, 0, x], [z, y, -x, 0]])
        return 0.5 * matrix @ q

    answer = solve_ivp(rate, (0.0, times[-1]), UPRIGHT, "DOP853", times, rtol=1e-12, atol=1e-13)
    return Rotation.from_quat(answer.y.T, scalar_first=True)


def error(count: int) -> float:
    """rad, of Bortz's equation at the end of 0.15 s in so many steps."""
    times = np.linspace(0.0, 0.15, count + 1)
    found = Rotation.from_quat(orientations(times, *coning(times), UPRIGHT), scalar_first=True)
    return float((found * by_quaternion(times).inv()).magnitude().max())


def test_bortz_and_quaternions_tell_the_same_orientation() -> None:
    assert error(1500) < 1e-9


def test_the_scheme_is_of_fourth_order() -> None:
    assert np.log2(error(150) / error(300)) == pytest.approx(4.0, abs=0.3)


@given(st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3), st.lists(st.floats(-30.0, 30.0), min_size=3, max_size=3))
def test_the_rate_is_that_of_the_rotation_vector(turn, omega) -> None:
    turn, omega, step = np.array(turn), np.array(omega), 1e-5
    if np.linalg.norm(turn) > 3.0:  # where a rotation vector jumps to the other side
        return
    ahead, behind = (Rotation.from_rotvec(turn) * Rotation.from_rotvec(s * omega) for s in (step, -step))
    expected = (ahead.as_rotvec() - behind.as_rotvec()) / (2 * step)
    np.testing.assert_allclose(bortz_rate(turn, omega), expected, atol=1e-5 * (1.0 + np.linalg.norm(omega)))


def test_no_angle_is_too_large() -> None:
    """Ten turns in a second."""
    times = np.linspace(0.0, 1.0, 2001)
    omega = np.broadcast_to([0.0, 20.0 * np.pi, 0.0], (2001, 3))
    found = orientations(times, omega, np.zeros((2001, 3)), UPRIGHT)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=1e-14)
    np.testing.assert_allclose(found[-1] * np.sign(found[-1, 0]), UPRIGHT, atol=1e-10)


def test_a_body_that_starts_turned_goes_on_from_there() -> None:
    times = np.linspace(0.0, 0.1, 101)
    start = Rotation.from_rotvec([0.3, -0.2, 1.0])
    found = orientations(times, *coning(times), start.as_quat(scalar_first=True))
    upright = Rotation.from_quat(orientations(times, *coning(times), UPRIGHT), scalar_first=True)
    turned = Rotation.from_quat(found, scalar_first=True)
    assert (turned * (start * upright).inv()).magnitude().max() < 1e-12
