"""Recordings that were never made."""

import numpy as np
import pytest

from crashkit_accelerometers import Accelerometer, recorded

TIMES = np.arange(2001) * 1e-4


@pytest.mark.parametrize("cfc", [0, 180])
def test_the_noise_is_as_large_as_stated_after_the_filter(turning, sensors, cfc) -> None:
    instrument = sensors([[0.1, 0.2, 0.3], [0.0, 0.0, 0.0]], TIMES, cfc=cfc, std=2.0)
    motion = turning(TIMES)
    noise = (
        recorded(Accelerometer(), motion, instrument)["acceleration"]
        - Accelerometer().predict(motion, instrument)["acceleration"]
    )
    assert float(noise.std()) == pytest.approx(2.0, rel=0.1)
    neighbours = np.corrcoef(noise.values[1:, 0, 0], noise.values[:-1, 0, 0])[0, 1]
    assert (neighbours > 0.9) == (cfc > 0)


def test_the_digitiser_rounds_and_says_so(turning, sensors) -> None:
    instrument = sensors([[0.1, 0.2, 0.3]], TIMES, std=0.1)
    digitised = recorded(Accelerometer(), turning(TIMES), instrument, resolution=0.5)
    np.testing.assert_allclose(digitised["acceleration"] % 0.5 % 0.5, 0.0, atol=1e-9)
    error = digitised["acceleration"] - Accelerometer().predict(turning(TIMES), instrument)["acceleration"]
    assert float(digitised["acceleration_std"][0]) == pytest.approx(np.hypot(0.1, 0.5 / np.sqrt(12)))
    assert float(error.std()) == pytest.approx(float(digitised["acceleration_std"][0]), rel=0.05)


def test_the_same_seed_gives_the_same_recording(turning, sensors) -> None:
    one, two, other = (recorded(Accelerometer(), turning(TIMES), sensors([[0, 0, 0]], TIMES), seed=s) for s in (1, 1, 2))
    assert one.identical(two)
    assert not one.identical(other)
