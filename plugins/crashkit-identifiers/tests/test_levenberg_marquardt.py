"""Steps within bounds."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from crashkit_identifiers import levenberg_marquardt
from crashkit_identifiers.levenberg_marquardt import Search, damped_step


class Bounded:
    """What a step asks of a problem."""

    def __init__(self, lower: np.ndarray, upper: np.ndarray) -> None:
        self._bounds = lower, upper

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return self._bounds

    def scaling(self, point: np.ndarray) -> np.ndarray:
        return np.ones(len(point))


@pytest.fixture
def solutions(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The sizes of the systems that were solved."""
    sizes: list[int] = []
    solve = np.linalg.solve

    def counted(matrix: np.ndarray, side: np.ndarray) -> Any:
        sizes.append(len(matrix))
        return solve(matrix, side)

    monkeypatch.setattr(levenberg_marquardt.np.linalg, "solve", counted)
    return sizes


def step_of(jacobian: np.ndarray, residual: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    cost = 0.5 * float(residual @ residual)
    search = Search(np.zeros(len(lower)), cost, jacobian.T @ residual, jacobian.T @ jacobian, 1e-12)
    return damped_step(Bounded(lower, upper), search, np.inf)  # type: ignore[arg-type]


def system(seed: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return random.normal(size=(3 * size, size)), random.normal(size=3 * size)


@given(st.integers(0, 10**6), st.integers(1, 12))
def test_a_step_is_the_least_of_the_parabola_within_the_bounds(seed: int, size: int) -> None:
    jacobian, residual = system(seed, size)
    random = np.random.default_rng(seed + 1)
    lower, upper = -random.uniform(0.01, 0.5, size), random.uniform(0.01, 0.5, size)
    expected = lsq_linear(jacobian, -residual, (lower, upper), method="bvls", tol=1e-14).x
    assert step_of(jacobian, residual, lower, upper) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_a_variable_that_is_held_is_taken_out_once(seed: int, solutions: list[int]) -> None:
    """Whichever way its slope points."""
    jacobian, residual = system(seed, 20)
    lower, upper = np.full(20, -10.0), np.full(20, 10.0)
    lower[7] = upper[7] = 0.0
    move = step_of(jacobian, residual, lower, upper)
    others = np.arange(20) != 7
    assert move[7] == 0.0
    assert move[others] == pytest.approx(np.linalg.lstsq(jacobian[:, others], -residual, rcond=None)[0], abs=1e-7)
    assert solutions == [20, 20, 19]
