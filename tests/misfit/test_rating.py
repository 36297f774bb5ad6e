"""ISO/TS 18571: checked against an independent implementation and by what a rating must mean."""

import math
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crashkit.misfit.rating import Rating, rating

INTERVAL = 1e-4


def pulse(count: int = 600, width: float = 0.5, height: float = 300.0) -> np.ndarray:
    """A crash pulse that rises, oscillates and ends in a rebound."""
    phase = np.linspace(0.0, 1.0 / width, count)
    return height * np.sin(np.pi * np.clip(phase, 0, 1.1)) * (1 + 0.2 * np.sin(25 * phase))


def scores(result: Rating) -> list[float]:
    return [result.total, result.corridor, result.phase, result.magnitude, result.slope]


@pytest.fixture(scope="module")
def peer() -> ModuleType:
    return pytest.importorskip("objective_rating_metrics.rating", reason="needs objective-rating-metrics")


def peer_scores(peer: ModuleType, reference: np.ndarray, simulated: np.ndarray) -> list[float]:
    times = INTERVAL * np.arange(len(reference))
    metric = peer.ISO18571(np.column_stack([times, reference]), np.column_stack([times, simulated]))
    parts = (metric.overall_rating, metric.corridor_rating, metric.phase_rating, metric.magnitude_rating, metric.slope_rating)
    return [float(part(ndigits=-1)) for part in parts]


@pytest.mark.slow  # the other implementation compiles for seconds
@pytest.mark.parametrize("delay", [0, 15, -40, 150])
@pytest.mark.parametrize("gain", [1.0, 0.85, 1.4])
def test_a_crash_pulse_is_rated_as_by_the_independent_implementation(peer: ModuleType, delay: int, gain: float) -> None:
    noise = np.random.default_rng(delay + 100).normal(size=(2, 600))
    reference = pulse() + 4 * noise[0]
    simulated = gain * np.roll(pulse(width=0.55), delay) + 2 * noise[1]
    assert scores(rating(reference, simulated, INTERVAL)) == pytest.approx(peer_scores(peer, reference, simulated), abs=1e-9)


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(30, 400), noise=st.floats(0.0, 3.0))
def test_random_walks_are_rated_as_by_the_independent_implementation(
    peer: ModuleType, seed: int, count: int, noise: float
) -> None:
    generator = np.random.default_rng(seed)
    reference = np.cumsum(generator.normal(size=count))
    simulated = reference + noise * np.cumsum(generator.normal(size=count))
    assert scores(rating(reference, simulated, INTERVAL)) == pytest.approx(peer_scores(peer, reference, simulated), abs=1e-9)


def test_a_curve_rates_itself_perfect() -> None:
    assert scores(rating(pulse(), pulse(), INTERVAL)) == pytest.approx([1.0] * 5)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10_000), scale=st.floats(1e-3, 1e6))
def test_scores_lie_between_0_and_1_and_do_not_depend_on_the_unit(seed: int, scale: float) -> None:
    reference, simulated = np.cumsum(np.random.default_rng(seed).normal(size=(2, 100)), axis=1)
    result = scores(rating(reference, simulated, INTERVAL))
    assert all(0.0 <= score <= 1.0 for score in result)
    assert scores(rating(scale * reference, scale * simulated, INTERVAL)) == pytest.approx(result, abs=1e-6)


def test_a_pure_delay_costs_phase_and_neither_magnitude_nor_slope() -> None:
    reference = np.concatenate([np.zeros(200), pulse(400, width=1.0), np.zeros(200)])
    result = rating(reference, np.roll(reference, 80), INTERVAL)
    assert result.phase == pytest.approx(0.5)
    assert (result.magnitude, result.slope) == pytest.approx((1.0, 1.0))


def test_a_coarse_curve_is_resampled_to_10_khz() -> None:
    fine, fine_simulated = pulse(1001), 0.9 * pulse(1001, width=0.55)
    coarse = rating(fine[::10], fine_simulated[::10], 1e-3)
    assert scores(coarse) == pytest.approx(scores(rating(fine, fine_simulated, INTERVAL)), abs=0.01)


def test_missing_samples_are_interpolated() -> None:
    reference, simulated = pulse(), 0.9 * pulse(width=0.55)
    hidden = reference.copy()
    hidden[100:110] = np.nan
    assert scores(rating(hidden, simulated, INTERVAL)) == pytest.approx(
        scores(rating(reference, simulated, INTERVAL)), abs=0.01
    )


@pytest.mark.parametrize(
    ("reference", "simulated"),
    [
        (np.zeros(100), np.ones(100)),
        (np.full(100, 3.0), pulse(100)),
        (np.full(100, np.nan), pulse(100)),
        (pulse(100), np.full(100, np.nan)),
        (pulse(5), pulse(5)),
        (np.array([]), np.array([])),
    ],
)
def test_a_curve_that_cannot_be_rated_gives_nan_without_a_warning(reference: np.ndarray, simulated: np.ndarray) -> None:
    assert all(math.isnan(score) for score in scores(rating(reference, simulated, INTERVAL)))


def test_a_simulation_that_does_not_move_is_not_shifted() -> None:
    result = rating(pulse(), np.zeros(600), INTERVAL)
    assert result.phase == 1.0
    assert result.magnitude == 0.0
