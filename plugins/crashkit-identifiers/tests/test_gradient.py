"""The gradient method: the contract, slices of time, and that it says how far it did not come."""

import numpy as np
import pytest

from crashkit.protocols import Status
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.gradient import Gradient
from crashkit_identifiers.run import run


class TestGradient(IdentifierContract):
    """A yardstick: of the toys it must only be honest."""

    recovers = ()

    @pytest.fixture
    def identifier(self):
        return Gradient(slices=2, steps_per_slice=15)


def test_it_works_on_one_slice_after_the_other_and_never_climbs(search):
    problem, method = search(toys.one_degree()), Gradient(steps_per_slice=10)
    state, slices = method.start(problem), []
    while state.status is Status.RUNNING:
        before, state = state, method.step(problem, state)
        slices.append(state.slice)
        assert state.slice > before.slice or state.cost <= before.cost
    assert sorted(set(slices)) == [1, 2, 3, 4] and slices == sorted(slices)


def test_the_first_slice_only_knows_its_own_time(search):
    problem, method = search(toys.one_degree()), Gradient(slices=20)
    early = method.step(problem, method.start(problem)).point - problem.start()
    moved = dict(zip(problem.names, early, strict=True))
    assert moved["joint.first.elastic_stiffness"] > 0.0
    assert moved["joint.first.densification_stiffness"] == 0.0


def test_it_comes_closer_and_says_that_it_has_not_arrived(search, errors):
    truth = toys.one_degree()
    found = run(Gradient(steps_per_slice=25), search(truth))
    assert found.cost < 1e-3 * 0.5 * np.sum(search(truth).residual(search(truth).start()) ** 2)
    assert found.status is not Status.CONVERGED
    assert max(map(abs, errors(found, truth).values())) > 1e-4
