"""The instruments: noise as announced, filters as the standard says, faults as the secret says."""

import math

import numpy as np
import pytest
from scipy import signal

from crashkit.testing.concealed.sensors import Instrument, Sensor, j211, noise_gain, read, record
from crashkit.testing.concealed.world import Trace, World, WorldJoint, run

DURATION = 0.15


@pytest.fixture(scope="module")
def trace() -> Trace:
    bodies = {"wall": {"position": 0.0, "moving": 0.0}, "body": {"position": -1.0, "mobility": 1e-3}}
    return run(World(bodies, {"front": WorldJoint("wall", "body", {"elastic_stiffness": 1e6})}), 10.0, DURATION + 0.04)


def accelerometer(cfc: int = 0, **faults: float) -> Instrument:
    return Instrument("accelerometer", 10000.0, {"acc": Sensor("body", 4.0, **faults)}, cfc)


def samples(instrument: Instrument, trace: Trace, seed: int | None = None) -> np.ndarray:
    rng = None if seed is None else np.random.default_rng(seed)
    (sensor,) = instrument.sensors.values()
    return read(instrument, sensor, trace, DURATION, rng)


@pytest.mark.parametrize("cfc", [0, 60, 180, 600])
def test_noise_has_the_std_that_the_recording_gives(trace: Trace, cfc: int) -> None:
    instrument = accelerometer(cfc)
    noise = np.concatenate([samples(instrument, trace, seed) - samples(instrument, trace) for seed in range(40)])
    assert noise.std() == pytest.approx(instrument.recorded_std(instrument.sensors["acc"]), rel=0.06)


def test_the_share_of_noise_that_passes_is_the_area_under_the_squared_response() -> None:
    """The integral of 1 / (1 + x^4)^2 from 0 to infinity is 3 pi / (8 sqrt 2); the warping of frequencies is small."""
    share = 2.0775 * 60 * 3.0 * math.pi / (8.0 * math.sqrt(2.0)) / 5000.0
    assert noise_gain(60, 10000.0) == pytest.approx(share, rel=0.01)


@pytest.mark.parametrize("cfc", [60, 180, 600])
def test_the_filter_is_a_butterworth_run_both_ways(cfc: int) -> None:
    value = np.zeros(4000)
    value[1500:2500] = np.random.default_rng(1).standard_normal(1000)
    numerator, denominator = signal.butter(2, 2.0775 * cfc, fs=10000.0)
    expected = signal.filtfilt(numerator, denominator, value)
    assert j211(value, cfc, 10000.0) == pytest.approx(expected, abs=1e-9)


def test_an_accelerometer_reads_the_true_acceleration(trace: Trace) -> None:
    assert samples(accelerometer(), trace) == pytest.approx(trace.acceleration["body"][:15000:10], abs=1e-6)


def test_a_load_cell_reads_the_push_on_the_wall(trace: Trace) -> None:
    cell = Instrument("load_cell", 10000.0, {"wall": Sensor("wall", 100.0)})
    assert samples(cell, trace) == pytest.approx(-1000.0 * samples(accelerometer(), trace), abs=1e-3)


def test_gain_and_bias_and_drift_are_in_the_reading(trace: Trace) -> None:
    times = np.arange(1500) / 10000.0
    faulty = samples(accelerometer(gain=1.2, bias=3.0, drift=50.0), trace)
    assert faulty == pytest.approx(1.2 * samples(accelerometer(), trace) + 3.0 + 50.0 * times, abs=1e-9)


def test_a_late_clock_stamps_later_events(trace: Trace) -> None:
    late = accelerometer()
    late.clock_offset = 0.002
    assert samples(late, trace)[:-20] == pytest.approx(samples(accelerometer(), trace)[20:], abs=1e-6)


def test_film_before_the_contact_flies_freely(trace: Trace) -> None:
    film = Instrument("film", 1000.0, {"target": Sensor("body", 1e-3)}, clock_offset=-0.003)
    assert samples(film, trace)[:4] == pytest.approx([-1.03, -1.02, -1.01, -1.0], abs=1e-6)


def test_clipping_keeps_to_the_limit(trace: Trace) -> None:
    assert np.abs(samples(accelerometer(limit=150.0), trace, 3)).max() == 150.0


def test_a_mounting_rings_at_its_frequency(trace: Trace) -> None:
    ringing = samples(accelerometer(ring_share=1.0, ring_frequency=400.0, ring_damping=0.02), trace)
    extra = ringing - samples(accelerometer(), trace)
    spectrum = np.abs(np.fft.rfft(extra * np.hanning(len(extra))))
    assert np.fft.rfftfreq(len(extra), 1e-4)[spectrum.argmax()] == pytest.approx(400.0, abs=10.0)


def test_a_recording_hides_frames_and_tells_its_noise_only_if_known(trace: Trace) -> None:
    film = Instrument("film", 1000.0, {"target": Sensor("body", 1e-3, hidden=0.1, block=(0.05, 0.06))}, std_given=False)
    tree = record({"film": film}, trace, DURATION, 10.0, ["body"], np.random.default_rng(1))
    position = tree["film"]["position"]
    assert position.sel(time=slice(0.0501, 0.0599)).isnull().all()
    assert 0.05 < float(position.isnull().mean()) < 0.35
    assert "position_std" not in tree["film"]
    assert math.isclose(float(tree["initial"]["position"][0, 0]), -1.0)
