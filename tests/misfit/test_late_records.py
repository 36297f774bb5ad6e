"""Filtered records that begin after contact: the filter remembers what happened before the first sample."""

import numpy as np
import pytest

from crashkit.misfit import Misfit
from crashkit.model import Parameter
from crashkit.model.edit import with_instrument_error
from crashkit.registry import load

INTERVAL = 2e-4
"""s, between samples."""
LATE = 100
"""Samples that a late record lacks: the spring is well loaded by then."""


def filtered(tree):
    changed = tree.copy()
    changed["accelerometer"].attrs["channel_frequency_class"] = 180
    return changed


@pytest.fixture
def run(recorded, model):
    return filtered(recorded(model, interval=INTERVAL))


def read(model, run):
    """What the accelerometer is predicted to read, and how that depends on the stiffness, (time,) each."""
    registry = load()
    misfit = Misfit(model, {"run": run}, registry.spring_laws, registry.observers)
    told = misfit.predictor.predict(misfit.values(misfit.start()), sensitivities=True)
    number = next(i for i, group in enumerate(misfit.groups) if group.name == "accelerometer")
    return told[number].samples[:, 0], told[number].sensitivity[:, 0, 0]


def test_a_late_record_reads_as_the_rest_of_a_whole_one(run, model):
    for late, whole in zip(read(model, run.isel(time=slice(LATE, None))), read(model, run), strict=True):
        assert np.abs(whole[LATE]) > 0.05 * np.abs(whole).max()
        np.testing.assert_allclose(late, whole[LATE:], atol=1e-6 * np.abs(whole).max())


def test_a_late_record_of_a_clock_that_runs_slow_reads_as_the_rest_of_a_whole_one(run, model):
    slow = with_instrument_error(model, "accelerometer", "", "clock_rate", Parameter(-0.05, -0.1, 0.1, True))
    for late, whole in zip(read(slow, run.isel(time=slice(LATE, None))), read(slow, run), strict=True):
        seen = np.isfinite(late)
        assert seen.mean() > 0.8
        np.testing.assert_allclose(late[seen], whole[LATE:][seen], atol=1e-3 * np.nanmax(np.abs(whole)))


def test_a_record_with_a_late_clock_reads_as_what_it_saw(run, model):
    ahead = with_instrument_error(model, "accelerometer", "", "clock_offset", Parameter(-LATE * INTERVAL, -0.1, 0.1, True))
    late = read(ahead, run.isel(time=slice(None, -LATE)))
    for ours, whole in zip(late, read(model, run), strict=True):
        np.testing.assert_allclose(ours, whole[LATE:], atol=1e-6 * np.abs(whole).max())
