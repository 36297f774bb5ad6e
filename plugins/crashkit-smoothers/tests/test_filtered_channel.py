"""Channels whose noise went through the filter of a frequency class: neighbouring errors are alike."""

import numpy as np
import pytest

from crashkit.data.channel_filter import filter_channel
from crashkit.protocols import Smoother
from crashkit.testing.smoother_contract import channel, rms
from crashkit_smoothers import AdaptiveQuintic, GcvQuintic, Spectral

TIMES = np.arange(1500) * 1e-4
NOISE = 20.0  # m s-2, before the filter


def recorded(cfc: int, draw: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A crash pulse with a ripple, filtered, with the same filter's noise: samples, truth, noise."""
    phase = np.clip((TIMES - 0.02) / 0.1, 0.0, 1.0)
    pulse = -200.0 * np.sin(np.pi * phase) * (1.0 + 0.3 * np.sin(2.0 * np.pi * 45.0 * TIMES))
    noise = filter_channel(np.random.default_rng(draw).normal(scale=NOISE, size=1500), TIMES, cfc)
    truth = filter_channel(pulse, TIMES, cfc)
    return truth + noise, truth, noise


@pytest.mark.parametrize("cfc", [60, 180, 600])
@pytest.mark.parametrize("smoother", [GcvQuintic(), AdaptiveQuintic(), Spectral()], ids=lambda smoother: smoother.name)
def test_the_motion_is_told_from_filtered_noise(smoother: Smoother, cfc: int) -> None:
    gained, found, covered = [], [], []
    for draw in range(10):
        samples, truth, noise = recorded(cfc, draw)
        smooth = smoother.smooth(channel(TIMES, samples).assign_attrs(channel_frequency_class=cfc))
        error = smooth["value"].values - truth
        gained.append(rms(error) / rms(noise))
        found.append(smooth.attrs["noise_std"] / rms(noise))
        covered.append(np.mean(np.abs(error) < 2.0 * smooth["value_std"].values))
    assert np.median(gained) < (1.05 if cfc == 60 else 0.65)
    assert np.median(found) == pytest.approx(1.0, rel=0.6 if cfc == 60 else 0.1)
    assert np.mean(covered) > 0.85


def test_an_undeclared_filter_is_followed_sample_by_sample() -> None:
    samples, _, noise = recorded(180, 0)
    undeclared = GcvQuintic().smooth(channel(TIMES, samples))
    assert undeclared.attrs["noise_std"] < 0.1 * rms(noise)


def test_it_says_how_many_samples_are_independent() -> None:
    samples, _, _ = recorded(180, 0)
    choice = GcvQuintic().smooth(channel(TIMES, samples).assign_attrs(channel_frequency_class=180)).attrs["choice"]
    assert "for 1500 samples, 93 of them independent after the filter" in choice
    samples, _, _ = recorded(60, 0)
    choice = GcvQuintic().smooth(channel(TIMES, samples).assign_attrs(channel_frequency_class=60)).attrs["choice"]
    assert "so many that noise and motion can hardly be told apart" in choice
