"""Substructuring: the contract, and what one body alone can say."""

import numpy as np
import pytest

from crashkit.protocols import Status
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.measured import measured_motions
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity
from crashkit_identifiers.substructure import Substructure
from crashkit_identifiers.substructuring import Substructuring


class TestSubstructuring(IdentifierContract):
    @pytest.fixture
    def identifier(self):
        return Substructuring()


@pytest.fixture(scope="module")
def truth():
    return toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)


def test_a_part_holds_what_its_body_depends_on(search, truth):
    problem = search(truth, 1.0)
    engine = problem.predictor.simulator.engine
    parts = {body: Substructure(problem, measured_motions(problem), body, engine) for body in ("front", "rear")}
    assert len(parts["front"].names) == 8 and not any("mass" in name for name in parts["front"].names)
    assert {name.split(".")[1] for name in parts["rear"].names} == {"rear", "second"}
    for part in parts.values():
        assert np.abs(part.residual(part.start())).max() < 0.02


def test_a_body_of_unknown_mass_tells_only_ratios(search, truth):
    problem = search(truth, 1.0)
    rear = Substructure(problem, measured_motions(problem), "rear", problem.predictor.simulator.engine)
    _, jacobian = rear.residual_and_jacobian(rear.start())
    sizes = np.linalg.svd(jacobian, compute_uv=False)
    assert sizes[-1] < 1e-6 * sizes[-2]


def test_bodies_are_taken_one_after_the_other(search, truth):
    problem, method = search(truth), Substructuring()
    state, done = method.start(problem), []
    while state.status is Status.RUNNING:
        state = method.step(problem, state)
        done.append(len(state.parts))
    assert sorted(set(done)) == [0, 1, 2] and done == sorted(done)


def test_it_starts_another_method_from_afar(search, truth, errors):
    problem = search(truth, 0.5, speeds=(1.0, 1.5))
    first = run(Substructuring(), problem)
    found = run(Sensitivity(), problem.with_values(first.values))
    assert found.status is Status.CONVERGED and found.path.sizes["step"] <= 6
    assert max(map(abs, errors(found, truth).values())) < 1e-5


def test_what_no_body_feels_stays_near_where_it_was(search, errors):
    """As printed, the second spring never passes its plateau: its end and what follows are felt by nobody."""
    truth = toys.two_degrees()
    start = toys.start_from(truth, 0.9).with_values({"joint.second.densification_deformation": 0.7})
    found = errors(run(Substructuring(), search(truth, start)), truth)
    blind = [f"joint.second.densification_{kind}" for kind in ("deformation", "stiffness")]
    assert all(abs(found.pop(path)) < 0.5 for path in blind)
    assert max(map(abs, found.values())) < 1e-3
