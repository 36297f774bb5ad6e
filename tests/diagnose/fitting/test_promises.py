"""What two claims promise together: least squares of what each does to the equations of motion."""

import numpy as np
import pytest

from crashkit.diagnose.fitting.promises import Led, left_beside, promises_beside
from crashkit.protocols import Proposal


def claim(physics, residual, shared, own):
    proposal = Proposal(physics, "", {"joint": "first"}, None, tuple("ab"[: own.shape[1] - 1]), {})
    return Led(proposal, {}, residual, shared, own)


def test_what_two_claims_leave_is_the_least_squares_of_all_their_numbers():
    random = np.random.default_rng(1)
    shared, first, second = (random.normal(size=(60, count)) for count in (3, 2, 3))
    residual = random.normal(size=60)
    leader, other = claim("one", residual, shared, first), claim("other", random.normal(size=60), shared, second)
    # The last column is all that a claim changes: the leader's residual already holds that.
    together = np.column_stack([shared, first[:, :-1], second])
    left = residual - together @ np.linalg.lstsq(together, residual, rcond=None)[0]
    ((promised, *claims),) = promises_beside(leader, [leader, other])
    assert claims == [leader, other]
    assert promised - leader.price - other.price == pytest.approx(0.5 * left @ left, rel=1e-9)


def test_numbers_that_change_nothing_take_nothing_up():
    basis = np.linalg.qr(np.arange(12.0).reshape(6, 2) ** 2)[0]
    left = np.ones(6) - basis @ (basis.T @ np.ones(6))
    assert left_beside(left, basis, np.zeros((6, 2))) == pytest.approx(0.5 * left @ left)
