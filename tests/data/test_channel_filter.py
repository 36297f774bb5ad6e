import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crashkit.data.channel_filter import correlation_samples, filter_channel
from crashkit.errors import CrashkitError

CLASSES = [60, 180, 600, 1000]
TIMES = np.arange(2000) * 1e-4


def gain_at(frequency: float, cfc: int, rate: float = 1e5) -> float:
    """The amplitude in the middle of a long filtered cosine."""
    times = np.arange(int(max(60 / cfc, 8 / frequency) * rate)) / rate
    middle = times[len(times) // 2]
    return float(filter_channel(np.cos(2 * np.pi * frequency * (times - middle)), times, cfc)[len(times) // 2])


def sae_j211(values: np.ndarray, interval: float, cfc: float) -> np.ndarray:
    """Appendix C of SAE J211-1 word by word: y(t) = a0 x(t) + a1 x(t-1) + a2 x(t-2) + b1 y(t-1) + b2 y(t-2), then backward."""
    wd = 2 * math.pi * cfc * 2.0775
    wa = math.sin(wd * interval / 2) / math.cos(wd * interval / 2)
    a0 = wa**2 / (1 + 2**0.5 * wa + wa**2)
    b1 = -2 * (wa**2 - 1) / (1 + 2**0.5 * wa + wa**2)
    b2 = (-1 + 2**0.5 * wa - wa**2) / (1 + 2**0.5 * wa + wa**2)
    for _ in range(2):
        x, y = values, np.zeros_like(values)
        for t in range(2, len(x)):
            y[t] = a0 * x[t] + 2 * a0 * x[t - 1] + a0 * x[t - 2] + b1 * y[t - 1] + b2 * y[t - 2]
        values = y[::-1]
    return values


@pytest.mark.parametrize("cfc", CLASSES)
def test_the_filter_is_the_recursion_of_the_standard(cfc: int) -> None:
    pulse = np.where((TIMES > 0.08) & (TIMES < 0.12), np.sin(np.pi * (TIMES - 0.08) / 0.04), 0.0)
    np.testing.assert_allclose(filter_channel(pulse, TIMES, cfc), sae_j211(pulse, 1e-4, cfc), atol=1e-9)


@pytest.mark.parametrize("cfc", CLASSES)
def test_attenuation_lies_in_the_corridor_of_the_standard(cfc: int) -> None:
    """0.5 dB up to a tenth of the class, +0.5 -1 dB up to it, +0.5 -4 dB up to 1.65 times it, then -9 to -24 dB an octave."""

    def decibel(ratio: float) -> float:
        return 20 * math.log10(gain_at(ratio * cfc, cfc))

    assert abs(decibel(0.1)) < 0.5
    for ratio in (0.3, 0.6, 1.0):
        assert -1.0 < decibel(ratio) < 0.5
    for ratio in (1.3, 1.65):
        assert -4.0 < decibel(ratio) < 0.5
    for ratio in (2.0, 3.0):
        octaves = math.log2(ratio / 1.65)
        assert -4.0 - 24.0 * octaves < decibel(ratio) < 0.5 - 9.0 * octaves


@pytest.mark.parametrize(("cfc", "cutoff"), [(60, 100), (180, 300), (600, 1000)])
def test_both_passes_together_lose_three_decibel_at_the_cutoff(cfc: int, cutoff: float) -> None:
    assert gain_at(cutoff, cfc) == pytest.approx(10 ** (-3 / 20), abs=0.002)


@given(st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=60), st.sampled_from(CLASSES), st.floats(-10, 10))
def test_the_filter_is_linear(samples: list[float], cfc: int, factor: float) -> None:
    one = np.array(samples)
    two = np.cos(np.arange(len(one)))
    times = TIMES[: len(one)]
    together = filter_channel(one + factor * two, times, cfc)
    apart = filter_channel(one, times, cfc) + factor * filter_channel(two, times, cfc)
    np.testing.assert_allclose(together, apart, atol=1e-9)


@given(st.floats(-1e6, 1e6), st.sampled_from(CLASSES))
def test_a_constant_passes_unchanged(constant: float, cfc: int) -> None:
    filtered = filter_channel(np.full(50, constant), TIMES[:50], cfc)
    np.testing.assert_allclose(filtered, constant, rtol=1e-9, atol=1e-12)


def test_every_column_is_a_channel_of_its_own_and_time_may_be_any_axis() -> None:
    block = np.random.default_rng(1).normal(size=(300, 2, 1, 4))
    times = TIMES[:300]
    filtered = filter_channel(block, times, 180, before=0.0)
    np.testing.assert_array_equal(filtered[:, 1, 0, 2], filter_channel(block[:, 1, 0, 2], times, 180, before=0.0))
    turned = filter_channel(block.swapaxes(0, 3), times, 180, axis=3, before=0.0)
    np.testing.assert_array_equal(turned, filtered.swapaxes(0, 3))


def test_the_constant_before_the_first_sample_is_what_the_channel_had() -> None:
    pulse = np.where(TIMES < 0.1, 0.0, np.exp(-30.0 * (TIMES - 0.1)))
    whole = filter_channel(pulse, TIMES, 60)
    np.testing.assert_allclose(filter_channel(pulse[1000:], TIMES[1000:], 60, before=0.0), whole[1000:], atol=1e-12)
    assert abs(filter_channel(pulse[1000:], TIMES[1000:], 60) - whole[1000:]).max() > 0.1


def test_no_class_changes_nothing() -> None:
    values = np.array([1.0, np.nan, 3.0])
    np.testing.assert_array_equal(filter_channel(values, np.array([0.0, 1.0, 5.0]), 0), values)


@pytest.mark.parametrize(("cfc", "interval"), [(60, 1e-3), (180, 1e-4), (1000, 1e-4)])
def test_correlation_is_that_of_filtered_noise(cfc: int, interval: float) -> None:
    """The mean of a long record of filtered noise varies as the mean of that many times fewer independent samples."""
    noise = np.random.default_rng(2).normal(size=(4000, 1000))
    filtered = filter_channel(noise, np.arange(4000) * interval, cfc)[500:3500]
    ratio = 3000 * filtered.mean(axis=0).var() / filtered.var()
    assert correlation_samples(cfc, interval) == pytest.approx(ratio, rel=0.15)


def test_correlation_of_an_analogue_filter_is_the_closed_form() -> None:
    """The integral of 1 / (1 + r^4)^2 over all r is 3 pi / (4 sqrt 2)."""
    closed = 4 * math.sqrt(2) / (3 * math.pi) / (2.0775 * 180 * 1e-6)
    assert correlation_samples(180, 1e-6) == pytest.approx(closed, rel=1e-4)
    assert correlation_samples(180, 1e-4) == pytest.approx(16.05, abs=0.01)
    assert correlation_samples(0, 1e-4) == 1.0


def test_uneven_sampling_is_refused() -> None:
    times = np.array([0.0, 1e-4, 2e-4, 4e-4])
    with pytest.raises(CrashkitError, match="uniformly: expected every 0.0001333 s, found steps from 0.0001 s to 0.0002 s"):
        filter_channel(np.zeros(4), times, 180)


def test_sampling_too_slow_for_the_class_is_refused() -> None:
    with pytest.raises(CrashkitError, match="the sampling is too slow for CFC1000: expected more than 4155 Hz, found 1000 Hz"):
        filter_channel(np.zeros(10), np.arange(10) * 1e-3, 1000)
