"""What a user of a general solver would write gives the same motion: else it would be no peer."""

import numpy as np
import pytest

from benchmarks._mechanics.models import LAWS, cases
from benchmarks._mechanics.peers import peers
from benchmarks._mechanics.reference import Reference, compiler
from benchmarks.engine import check, positions
from crashkit.mechanics import simulate

needs_compiler = pytest.mark.skipif(compiler() is None, reason="the reference needs a C compiler")


@needs_compiler
@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_the_reference_in_c_goes_our_way(case):
    ours = positions(simulate(case.model, case.times, LAWS, step=case.step), case)
    check(case, ours, Reference(case.model).run(case.times, case.step)[0].position)


@needs_compiler
@pytest.mark.parametrize("name", ["one degree", "two degrees"])
def test_scipy_ends_where_we_end(name):
    case = next(case for case in cases() if case.name == name)
    solver = peers(case)["scipy DOP853"]
    moving = [body.name for body in case.model.bodies if not body.fixed]
    ours = simulate(case.model, case.times, LAWS, step=case.step)["position"].sel(body=moving).values[-1, :, 0]
    assert np.sort(solver()) == pytest.approx(np.sort(ours), abs=2e-5)
