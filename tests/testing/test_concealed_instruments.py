"""The instruments of the concealed world: noise as announced, filters as the standard says, faults as the secret says."""

import math

import numpy as np
import pytest
from scipy import signal

from crashkit.testing.concealed.instruments import GRAVITY, Instrument, Sensor, filtered, read
from crashkit.testing.concealed.recording import record
from crashkit.testing.concealed.scene import TAIL
from crashkit.testing.concealed.world import Body, Joint, Motion, World, run

DURATION = 0.15
SPRING = {
    "elastic_stiffness": 1e6,
    "crush_force": 1e9,
    "densification_deformation": 1e4,
    "densification_stiffness": 1.0,
}


@pytest.fixture(scope="module")
def motion() -> Motion:
    bodies = {"wall": Body(0.0, moves=False), "cart": Body(-1.0, 1000.0)}
    return run(World(bodies, {"front": Joint("wall", "cart", "crush_plateau", SPRING)}), 10.0, DURATION + TAIL)


def accelerometer(cfc: int = 0, **faults: object) -> Instrument:
    return Instrument("accelerometer", 10000.0, {"a": Sensor("cart", 4.0, **faults)}, cfc)


def samples(instrument: Instrument, motion: Motion, seed: int | None = None) -> np.ndarray:
    rng = None if seed is None else np.random.default_rng(seed)
    (sensor,) = instrument.sensors.values()
    return read(instrument, sensor, motion, DURATION, rng)


@pytest.mark.parametrize("cfc", [0, 60, 180, 600])
def test_noise_has_the_std_that_the_recording_gives(motion, cfc):
    instrument = accelerometer(cfc)
    noise = np.concatenate([samples(instrument, motion, seed) - samples(instrument, motion) for seed in range(40)])
    assert noise.std() == pytest.approx(instrument.recorded_std(instrument.sensors["a"]), rel=0.06)


def test_the_share_of_noise_that_passes_is_the_area_under_the_squared_response():
    """The integral of 1 / (1 + x^4)^2 from 0 to infinity is 3 pi / (8 sqrt 2); the warping of frequencies is small."""
    share = 2.0775 * 60 * 3.0 * math.pi / (8.0 * math.sqrt(2.0)) / 5000.0
    instrument = accelerometer(60)
    assert (instrument.recorded_std(instrument.sensors["a"]) / 4.0) ** 2 == pytest.approx(share, rel=0.01)


@pytest.mark.parametrize("cfc", [60, 180, 600])
def test_the_filter_is_a_butterworth_run_both_ways(cfc):
    value = np.zeros(4000)
    value[1500:2500] = np.random.default_rng(1).standard_normal(1000)
    expected = signal.filtfilt(*signal.butter(2, 2.0775 * cfc, fs=10000.0), value)
    assert filtered(value, cfc, 10000.0) == pytest.approx(expected, abs=1e-9)


def test_an_accelerometer_reads_the_true_acceleration(motion):
    assert samples(accelerometer(), motion) == pytest.approx(motion.acceleration["cart"][:15000:10], abs=1e-6)


def test_a_load_cell_reads_the_push_on_the_wall(motion):
    cell = Instrument("load_cell", 10000.0, {"plate": Sensor("wall", 100.0)})
    assert samples(cell, motion) == pytest.approx(-1000.0 * samples(accelerometer(), motion), abs=1e-3)


def test_gain_bias_drift_and_shift_are_in_the_reading(motion):
    times = np.arange(1500) / 10000.0
    faulty = samples(accelerometer(gain=1.2, bias=3.0, drift=50.0, shift=2.0, shift_at=0.05), motion)
    expected = 1.2 * samples(accelerometer(), motion) + 3.0 + 50.0 * times + 2.0 * (times >= 0.05)
    assert faulty == pytest.approx(expected, abs=1e-9)


def test_a_tilted_sensor_reads_a_part_and_a_part_of_gravity(motion):
    expected = math.cos(0.3) * samples(accelerometer(), motion) + math.sin(0.3) * GRAVITY
    assert samples(accelerometer(tilt=0.3), motion) == pytest.approx(expected, abs=1e-9)


def test_a_late_clock_stamps_later_events(motion):
    late = accelerometer()
    late.clock_offset = 0.002
    assert samples(late, motion)[:-20] == pytest.approx(samples(accelerometer(), motion)[20:], abs=1e-6)


def test_film_before_the_contact_flies_freely(motion):
    film = Instrument("film", 1000.0, {"dot": Sensor("cart", 1e-3)}, clock_offset=-0.003)
    assert samples(film, motion)[:4] == pytest.approx([-1.03, -1.02, -1.01, -1.0], abs=1e-6)


def test_clipping_keeps_to_the_limits(motion):
    clipped = samples(accelerometer(low=-150.0, high=5.0), motion, 3)
    assert (clipped.min(), clipped.max()) == (-150.0, 5.0)
    soft = samples(accelerometer(low=-150.0, high=150.0, soft=True), motion)
    assert soft == pytest.approx(150.0 * np.tanh(samples(accelerometer(), motion) / 150.0))


def test_a_mounting_rings_at_its_frequency(motion):
    extra = samples(accelerometer(ring=(1.0, 400.0, 0.02)), motion) - samples(accelerometer(), motion)
    spectrum = np.abs(np.fft.rfft(extra * np.hanning(len(extra))))
    assert np.fft.rfftfreq(len(extra), 1e-4)[spectrum.argmax()] == pytest.approx(400.0, abs=10.0)


def test_a_turning_body_moves_film_and_accelerometer_alike(motion):
    """The film's difference is the accelerometer's, integrated twice."""
    pitch = (0.2, 30.0, 0.3)
    film, still = (Instrument("film", 1e4, {"dot": Sensor("cart", 1.0, pitch=p)}) for p in (pitch, (0.0, 1.0, 0.0)))
    moved = samples(film, motion) - samples(still, motion)
    shaken = samples(accelerometer(pitch=pitch), motion) - samples(accelerometer(), motion)
    assert np.gradient(np.gradient(moved, 1e-4), 1e-4)[5:-5] == pytest.approx(shaken[5:-5], abs=0.01 * np.abs(shaken).max())


def test_a_recording_hides_frames_and_tells_its_noise_only_if_known(motion):
    film = Instrument("film", 1000.0, {"dot": Sensor("cart", 1e-3, hidden=0.1, block=(0.05, 0.06))}, std_given=False)
    tree = record({"film": film}, motion, DURATION, ["cart"], np.random.default_rng(1))
    position = tree["film"]["position"]
    assert position.sel(time=slice(0.0501, 0.0599)).isnull().all()
    assert 0.05 < float(position.isnull().mean()) < 0.35
    assert "position_std" not in tree["film"]
    assert float(tree["initial"]["position"][0, 0]) == -1.0
