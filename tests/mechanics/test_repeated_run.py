"""A run whose steps pass the times asked for says there what one whose steps end there says."""

import numpy as np
import pytest

from crashkit.mechanics.repeated_run import RepeatedRun

TIMES = np.linspace(0.0, 0.08, 401)
STEP = 5e-4


@pytest.fixture
def runs(car, simulator):
    """Records of a crash with sensitivities: steps that end at some of the times, or at all of them and are short."""

    def run(axes, stops, step=STEP):
        model = car(axes)
        paths = list(model.free_parameters())
        repeated = RepeatedRun(simulator(model), TIMES, paths, step=step, stops=stops)
        values = np.array([model.free_parameters()[path].value for path in paths])
        record = repeated.record(values, sensitivities=True)
        return record.values.copy(), record.tangents.copy()

    return run


def motions(values, tangents, axes):
    """Positions, velocities and accelerations, without what is about axes: those of space have rotations of a step."""
    size = {1: 1, 2: 3, 3: 6}[axes]
    bodies = [i for i in range(size * 2) if i % size < axes]
    return values[:, bodies], tangents[:, bodies]


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_motions_between_the_ends_of_steps_are_those_of_steps_that_end_there(runs, axes):
    told, exact = runs(axes, TIMES[:0]), runs(axes, None, 2e-5)
    for between, there in zip(motions(*told, axes), motions(*exact, axes), strict=True):
        np.testing.assert_allclose(between, there, atol=1e-5 * np.abs(there).max())


@pytest.mark.parametrize("axes", [1, 2])
def test_their_error_falls_with_the_third_power_of_the_step_or_faster(runs, axes):
    exact, _ = motions(*runs(axes, None, 1e-5), axes)
    errors = [np.abs(motions(*runs(axes, TIMES[:0], step), axes)[0] - exact).max() for step in (1e-3, 5e-4)]
    assert errors[1] < errors[0] / 7.0


def test_forces_are_known_where_steps_end_and_nowhere_else(runs):
    some = TIMES[::4]
    values, _ = runs(1, some)
    everywhere, _ = runs(1, None)
    forces = np.isnan(values).any(axis=0)
    assert forces.any() and not np.isnan(values[::4]).any()
    assert np.isnan(values[1::4][:, forces]).all()
    scale = np.abs(everywhere).max(axis=0)
    np.testing.assert_allclose(values[::4], everywhere[::4], atol=1e-4 * scale.max())
