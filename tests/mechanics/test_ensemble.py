"""Many runs at once: the same as one after the other."""

import numpy as np
import pytest

from crashkit.errors import CrashkitError
from crashkit.mechanics import Simulator, ensemble, simulate_many
from crashkit.testing import toys

TIMES = np.linspace(0.0, 2.0, 41)
FORCES = np.linspace(1e4, 5e4, 9)


@pytest.fixture(scope="module")
def simulator(laws):
    return Simulator(toys.two_degrees(), laws)


def values_of(simulator):
    path = next(path for path in simulator.model.parameters() if path.endswith("crush_force"))
    body = next(body.name for body in simulator.model.bodies if not body.fixed)
    return {path: FORCES, f"body.{body}.mass": 1100.0, f"body.{body}.velocity": np.linspace(0.8, 1.2, 9)}


@pytest.mark.parametrize("workers", [1, 2, 4])
def test_they_are_one_simulation_after_the_other(simulator, workers):
    values = values_of(simulator)
    names = ("position", "acceleration", "force", "contact_force")
    motions = simulate_many(simulator, TIMES, values, quantities=names, workers=workers)
    assert motions["position"].dims == ("run", "time", "body", "axis")
    assert set(motions["status"].values) == {"completed"}
    for run in range(9):
        one = {path: float(np.broadcast_to(column, 9)[run]) for path, column in values.items()}
        alone = simulator.run(TIMES, one)
        for name in names:
            assert np.array_equal(motions[name].values[run], alone[name].values), name


def test_batches_make_no_difference(simulator, monkeypatch):
    whole = simulate_many(simulator, TIMES, values_of(simulator))
    monkeypatch.setattr(ensemble, "BATCH", 30_000)
    assert simulate_many(simulator, TIMES, values_of(simulator)).identical(whole)


def test_a_run_that_fails_says_so_and_leaves_the_others_alone(simulator):
    _, path, *_ = values_of(simulator)
    motions = simulate_many(simulator, TIMES, {path: [3e4, np.nan, 4e4]})
    assert motions["status"].values[0] == motions["status"].values[2] == "completed"
    assert "is not finite" in str(motions["status"].values[1])
    assert np.all(np.isnan(motions["position"].values[1]))
    assert np.all(np.isfinite(motions["position"].values[[0, 2]]))


def test_what_cannot_be_used(simulator):
    path, other, *_ = values_of(simulator)
    with pytest.raises(CrashkitError, match=r"expected one number for each run at every path, found \[2, 3\] numbers"):
        simulate_many(simulator, TIMES, {path: [1e4, 2e4], other: [1e3, 2e3, 3e3]})
    with pytest.raises(CrashkitError, match=r"expected quantities of a motion \(position.*\), found colour"):
        simulate_many(simulator, TIMES, {path: FORCES}, quantities=("colour",))
    with pytest.raises(CrashkitError, match='^expected a parameter of the model, found "nobody"$'):
        simulate_many(simulator, TIMES, {"nobody": FORCES})
    for wrong in ([-10.0, 1e3], [1e3, -10.0], -10.0):
        with pytest.raises(CrashkitError, match=r"^model .*: body.front.mass: expected a value above 0, found -10.0$"):
            simulate_many(simulator, TIMES, {"body.front.mass": wrong})
    with pytest.raises(CrashkitError, match=r"^expected one number for each run at every path, found 0 numbers$"):
        simulate_many(simulator, TIMES, {path: []})
    with pytest.raises(CrashkitError, match=r"^step: expected a positive number of seconds, found nan$"):
        simulate_many(simulator, TIMES, {path: FORCES}, step=np.nan)
