"""A force that only a wrong instrument shows is none; one that other channels show as well, or a known cause, stays."""

from types import SimpleNamespace

import numpy as np
import pytest

from crashkit.diagnose.fitting.evidence import Rival
from crashkit.diagnose.name.shown_alone import is_shown_alone
from crashkit.protocols import Proposal

SENSORS = [("film", "front"), ("film", "rear"), ("accelerometer", "front"), ("accelerometer", "rear")]
SENSOR = {"sensor": "rear", "instrument": "accelerometer"}


def fitted(physics, where, sums, samples=(100.0, 100.0, 100.0, 100.0)):
    """A claim that leaves so much of each channel."""
    channels = [
        SimpleNamespace(instrument=instrument, sensor=sensor, independent_samples=count)
        for (instrument, sensor), count in zip(SENSORS, samples, strict=True)
    ]
    misfit = SimpleNamespace(channels=channels, residual=lambda point: point, channel_deviances=lambda residual: residual)
    search = SimpleNamespace(misfit=misfit, point=np.array(sums))
    return Rival(Proposal(physics, "", where, None, (), {}), search, 0.0, 0.0)


@pytest.mark.parametrize(
    ("physics", "left", "is_form"),
    [
        ("unknown", (110.0, 100.0, 120.0, 150.0), True),
        ("unknown", (60.0, 80.0, 60.0, 150.0), False),
        ("fracture", (110.0, 100.0, 120.0, 150.0), False),
    ],
)
def test_what_the_other_channels_show_is_more_than_the_form_of_an_error(physics, left, is_form):
    reading = fitted("gain_error", SENSOR, (110.0, 100.0, 130.0, 900.0))
    assert is_shown_alone(reading, fitted(physics, {"joint": "front"}, left)) is is_form


@pytest.mark.parametrize(("samples", "is_form"), [((100.0, 100.0, 100.0, 250.0), True), ((100.0, 100.0, 100.0, 350.0), False)])
def test_a_sensor_with_most_samples_has_too_few_others_against_it(samples, is_form):
    reading = fitted("gain_error", SENSOR, (100.0, 100.0, 100.0, 900.0), samples)
    assert is_shown_alone(reading, fitted("unknown", {"joint": "front"}, (100.0, 100.0, 100.0, 150.0), samples)) is is_form


def test_a_whole_instrument_is_wrong_in_all_its_channels():
    reading = fitted("clock_error", {"instrument": "accelerometer"}, (100.0, 100.0, 500.0, 500.0))
    force = fitted("unknown", {"joint": "front"}, (100.0, 100.0, 200.0, 300.0))
    assert is_shown_alone(reading, force)
    assert not is_shown_alone(fitted("gain_error", SENSOR, (100.0, 100.0, 500.0, 500.0)), force)
