"""A run whose steps pass the times asked for says there what one whose steps end there says."""

import numpy as np
import pytest

from crashkit.mechanics.repeated_run import RepeatedRun

TIMES = np.linspace(0.0, 0.08, 401)
STEP = 5e-4
BODIES, JOINTS = 4, 4
DOF = {1: 1, 2: 3, 3: 6}


@pytest.fixture
def runs(car, simulator):
    """Records of a crash with sensitivities: steps that end at the last of the times only, or at all of them."""

    def run(axes, ends_at_all, step=STEP, wanted=None):
        model = car(axes)
        paths = list(model.free_parameters())
        repeated = RepeatedRun(simulator(model), TIMES, paths, step=step, ends_at_all=ends_at_all, wanted=wanted)
        values = np.array([model.free_parameters()[path].value for path in paths])
        record = repeated.record(values, sensitivities=True)
        return record.values.copy(), record.tangents.copy()

    return run


def parts(values, tangents, axes):
    """Positions, velocities, accelerations; forces, deformations and rates of joints; forces on bodies; with derivatives.

    Without what is about axes in space: positions there are rotations of a step.
    """
    n = BODIES * DOF[axes]
    straight = np.array([i for i in range(n) if i % DOF[axes] < axes])
    joints = 4 * n + 3 * np.arange(JOINTS)
    nets = 4 * n + 3 * JOINTS + np.arange(n)
    kinds = straight, n + straight, 3 * n + straight, joints, joints + 1, joints + 2, nets
    return [(values[:, kind], tangents[:, kind]) for kind in kinds]


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_between_the_ends_of_steps_all_is_as_if_they_ended_there(runs, axes):
    passing, ending = parts(*runs(axes, False), axes), parts(*runs(axes, True, 2e-5), axes)
    for kind, there in zip(passing, ending, strict=True):
        for one, other in zip(kind, there, strict=True):
            np.testing.assert_allclose(one, other, atol=1e-5 * np.abs(other).max())


@pytest.mark.parametrize("axes", [1, 2])
def test_the_error_falls_with_the_third_power_of_the_step_or_faster(runs, axes):
    exact = parts(*runs(axes, True, 1e-5), axes)
    longer, shorter = (parts(*runs(axes, False, step), axes) for step in (1e-3, 5e-4))
    for (there, _), (one, _), (other, _) in zip(exact, longer, shorter, strict=True):
        assert np.abs(other - there).max() < np.abs(one - there).max() / 7.0


def test_only_orientations_in_space_are_not_known_between_the_ends_of_steps(runs):
    for axes in (1, 2, 3):
        values, _ = runs(axes, False)
        unknown = np.isnan(values).any(axis=0)
        assert unknown.sum() == (4 * BODIES if axes == 3 else 0) and not unknown[: values.shape[1] - 4 * BODIES].any()
        assert not np.isnan(runs(axes, True)[0]).any()


@pytest.mark.parametrize("axes", [1, 2, 3])
@pytest.mark.parametrize("ends_at_all", [False, True])
def test_a_record_of_some_entries_is_that_part_of_the_full_one(runs, axes, ends_at_all):
    values, tangents = runs(axes, ends_at_all)
    told = tangents.shape[1]
    some = [told - 1, 0, 4 * BODIES * DOF[axes] + 1]
    for wanted in (range(0, told, 3), range(1, told, 2), some, range(values.shape[1]), []):
        some, slopes = runs(axes, ends_at_all, wanted=wanted)
        entries = sorted(wanted)
        np.testing.assert_array_equal(some, values[:, entries])
        np.testing.assert_array_equal(slopes, tangents[:, [entry for entry in entries if entry < told]])
