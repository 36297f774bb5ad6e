"""Accelerometers on a model that the engine simulates in the plane, with the engine's own sensitivities."""

from pathlib import Path

import numpy as np
import pytest

from crashkit.mechanics import Simulator
from crashkit.model.toml import read_model
from crashkit.registry import load
from crashkit_accelerometers import Accelerometer

MODEL = Path(__file__).parents[3] / "docs" / "examples" / "obstacles" / "offset_barrier.toml"
TIMES = np.arange(601) * 2e-4


@pytest.mark.parametrize("path", ["joint.rail_left.elastic_stiffness", "joint.rail_left.crush_force"])
def test_sensitivities_of_readings_are_those_of_the_simulation(sensors, path) -> None:
    laws = load().spring_laws
    model = read_model(MODEL, laws)
    simulator, value = Simulator(model, laws), model.parameters()[path].value
    instrument = sensors([[1.0, 0.5], [-0.8, -0.4]], TIMES, axes="xy", cfc=180)

    def read(change: float) -> np.ndarray:
        return Accelerometer().predict(simulator.run(TIMES, {path: value + change}), instrument)["acceleration"].values

    motion = simulator.run(TIMES, sensitivities=[path])
    found = Accelerometer().predict(motion, instrument)["acceleration_sensitivity"].values[..., 0]
    expected = (read(1e-5 * value) - read(-1e-5 * value)) / (2e-5 * value)
    assert np.abs(expected).max() > 0.0
    np.testing.assert_allclose(found, expected, atol=1e-4 * np.abs(expected).max())
