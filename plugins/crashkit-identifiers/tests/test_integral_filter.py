"""The integral filter: the contract, its windows, its penalty."""

import numpy as np
import pytest

from crashkit.errors import CrashkitError
from crashkit.protocols import Status
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.integral_filter import BASES, IntegralFilter
from crashkit_identifiers.run import run


class TestIntegralFilter(IdentifierContract):
    accuracy = 1e-3

    @pytest.fixture
    def identifier(self):
        return IntegralFilter()


@pytest.mark.parametrize("basis", BASES)
def test_windows_are_never_negative_and_independent(basis):
    windows = BASES[basis](np.linspace(0.0, 1.0, 201), 6)
    assert windows.shape == (201, 6)
    assert windows.min() >= -1e-12
    assert np.linalg.matrix_rank(windows) == 6


def test_windows_are_the_paper_s():
    share = np.array([0.25])
    assert BASES["power"](share, 3)[0] == pytest.approx([1.0, 0.25, 0.0625])
    assert BASES["sine"](share, 2)[0] == pytest.approx([np.sin(np.pi / 8.0), np.sin(np.pi / 4.0)])
    assert BASES["chebyshev"](share, 3)[0] == pytest.approx([1.0, 0.25, 0.25])


@pytest.mark.parametrize("basis", ["power", "sine"])
def test_the_other_bases_find_the_toy_too(search, errors, basis):
    truth = toys.one_degree()
    found = run(IntegralFilter(basis=basis), search(truth))
    assert found.status is Status.CONVERGED
    assert max(map(abs, errors(found, truth).values())) < 1e-3


def test_a_penalty_holds_the_start(search):
    problem = search(toys.one_degree())
    free, held = (run(IntegralFilter(penalty=penalty, step_limit=15), problem) for penalty in (0.0, 10.0))
    start = problem.parameters(problem.start())
    assert held.parameters["value"].values == pytest.approx(start, rel=0.02)
    assert np.abs(free.parameters["value"].values / start - 1.0).max() > 0.2


def test_a_weight_of_nothing_takes_a_quantity_out(search):
    problem = search(toys.one_degree())
    full, bare = (IntegralFilter(speed=speed).start(problem).cost for speed in (1.0, 0.0))
    only_speed = IntegralFilter(displacement=0.0).start(problem).cost
    assert full == pytest.approx(bare + only_speed)


def test_with_noise_there_is_no_zero_and_it_says_so(search):
    found = run(IntegralFilter(step_limit=30), search(toys.one_degree(), noise=0.05))
    assert found.status is not Status.CONVERGED


def test_an_unknown_basis_is_refused():
    with pytest.raises(CrashkitError, match="integral_filter: expected a basis of power, sine, chebyshev, found wavelet"):
        IntegralFilter(basis="wavelet")
