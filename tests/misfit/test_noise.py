"""Noise levels: given, or estimated from the samples themselves."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve
from hypothesis import given, settings
from hypothesis import strategies as st

from crashkit.data.channel_filter import filter_channel
from crashkit.misfit import Noise, channel_noise
from crashkit.misfit.noise import as_heard

TIMES = np.arange(2000) * 1e-4
PULSE = 200.0 * np.sin(np.pi * TIMES / 0.2) ** 2
NOISE = np.random.default_rng(1).normal(size=TIMES.size)


def instrument(cfc=0, **variables) -> xr.Dataset:
    declared = {name: ("sensor", values) for name, values in variables.items()}
    return xr.Dataset(declared, attrs={"channel_frequency_class": cfc})


def test_a_level_that_is_given_is_taken_channel_by_channel():
    given_levels = instrument(acceleration_std=[4.0, 7.0])
    assert channel_noise(given_levels, "acceleration", 1, PULSE, TIMES).std == 7.0
    assert channel_noise(given_levels, "acceleration", 1, PULSE, TIMES).trusted


@pytest.mark.parametrize("unknown", [np.nan, 0.0, -1.0])
def test_a_level_that_says_nothing_is_estimated(unknown):
    noise = channel_noise(instrument(acceleration_std=[unknown]), "acceleration", 0, PULSE + NOISE, TIMES)
    assert noise.std == pytest.approx(1.0, rel=0.06)


@given(level=st.floats(1e-6, 1e3), offset=st.floats(-1e2, 1e2), seed=st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_white_noise_is_estimated_without_a_model(level, offset, seed):
    samples = offset * level + level * (PULSE + np.random.default_rng(seed).normal(size=TIMES.size))
    noise = channel_noise(instrument(), "acceleration", 0, samples, TIMES)
    assert noise.std == pytest.approx(level, rel=0.25)
    assert noise.trusted
    assert noise.correlation == 1.0


def test_hidden_frames_do_not_enter_the_estimate():
    samples = PULSE + NOISE
    samples[200:260] = np.nan
    assert channel_noise(instrument(), "position", 0, samples, TIMES).std == pytest.approx(1.0, rel=0.06)


def test_samples_held_at_a_limit_do_not_enter_the_estimate():
    samples = np.minimum(PULSE + NOISE, 60.0)
    assert np.mean(np.diff(samples) == 0.0) > 0.5
    assert channel_noise(instrument(), "acceleration", 0, samples, TIMES).std == pytest.approx(1.0, rel=0.15)


def test_noise_that_was_filtered_is_only_an_estimate():
    samples = filter_channel(PULSE + 10.0 * NOISE, TIMES, 180)
    noise = channel_noise(instrument(180), "acceleration", 0, samples, TIMES)
    left = float(np.std(filter_channel(10.0 * NOISE, TIMES, 180)))
    assert not noise.trusted
    assert noise.std == pytest.approx(left, rel=0.5)
    assert noise.least == pytest.approx(0.5 * noise.std)


def test_filtered_noise_counts_as_fewer_samples():
    declared = instrument(180, acceleration_std=[4.0])
    noise = channel_noise(declared, "acceleration", 0, PULSE, TIMES)
    assert noise.trusted
    assert noise.correlation == pytest.approx(16.0, rel=0.01)
    assert noise.weight == pytest.approx(1.0 / (4.0 * np.sqrt(noise.correlation)))


def test_the_mean_of_filtered_noise_is_as_certain_as_its_independent_samples_say():
    correlation = channel_noise(instrument(180, force_std=[1.0]), "force", 0, PULSE, TIMES).correlation
    draws = np.random.default_rng(2).normal(size=(TIMES.size, 400))
    filtered = filter_channel(draws, TIMES, 180)[200:-200]
    mean_variance = float(filtered.mean(axis=0).var())
    assert mean_variance == pytest.approx(float(filtered.var()) * correlation / len(filtered), rel=0.25)


@pytest.mark.parametrize("samples", [np.zeros(50), np.full(50, 3.0)])
def test_a_channel_without_noise_still_has_a_level(samples):
    noise = channel_noise(instrument(), "force", 0, samples, TIMES[:50])
    assert 0.0 < noise.std < 1e-6


@pytest.mark.parametrize("present", [0, 1, 4])
def test_too_few_readings_for_an_estimate_still_give_a_level(present):
    samples = np.full(50, np.nan)
    samples[:present] = 1.0
    assert channel_noise(instrument(), "position", 0, samples, TIMES[:50]).std > 0.0


def test_a_channel_that_states_too_little_noise_has_what_is_left_of_it_if_that_is_white():
    heard = as_heard(Noise(0.6, 1.0, trusted=True), NOISE)
    assert heard.std == pytest.approx(1.0, rel=0.05)
    assert heard.louder == pytest.approx(heard.std / 0.6)
    again = as_heard(evolve(heard, std=0.5 * heard.std), NOISE)
    assert again.std == heard.std
    assert again.louder == pytest.approx(2.0 * heard.louder)


SMOOTH = 0.5 * np.sin(np.arange(TIMES.size) / 20.0)


@pytest.mark.parametrize(
    ("noise", "left"),
    [
        (Noise(0.6, 1.0, trusted=True), NOISE + SMOOTH),
        (Noise(0.6, 1.0, trusted=True), filter_channel(NOISE, TIMES, 600)),
        (Noise(0.6, 1.0, trusted=True), np.sqrt(2.0) * np.sin(0.5 * np.pi * np.arange(TIMES.size))),
        (Noise(0.95, 1.0, trusted=True), NOISE),
        (Noise(3.0, 1.0, trusted=True), NOISE),
        (Noise(0.6, 16.0, trusted=True), NOISE),
        (Noise(0.6, 1.0, trusted=False), NOISE),
        (Noise(0.6, 1.0, trusted=True), NOISE[:50]),
    ],
    ids=["structure", "filtered", "ringing", "hardly more", "less", "stated of filtered", "open", "few"],
)
def test_a_level_stays_where_what_is_left_may_be_more_than_noise(noise, left):
    assert as_heard(noise, left) == noise
