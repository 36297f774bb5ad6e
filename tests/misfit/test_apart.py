"""Corners of a curve are numbers of the model like others; a search moves them, and never past each other."""

import numpy as np
import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st

from crashkit.diagnose.fitting.search import begin
from crashkit.mechanics import Simulator
from crashkit.misfit import Misfit
from crashkit.misfit.apart import kept_apart
from crashkit.model import Joint, Parameter
from crashkit.testing import toys

CORNERS = (0.04, 0.1)


def curve(deformations, **bounds):
    """The toy with a broken line for a spring; what is given of `bounds` concerns its corners."""
    numbers = {
        "deformation": tuple(Parameter(one, **bounds) for one in deformations),
        "force": tuple(Parameter(3e4 + 2e5 * one) for one in deformations),
        "final_stiffness": Parameter(1e6),
        "unloading_stiffness": Parameter(2e6, 1.0),
    }
    return evolve(toys.one_degree(), joints=(Joint("first", ("wall", "front"), "piecewise_affine", numbers),))


def paths(count):
    return [f"joint.first.deformation[{i}]" for i in range(count)]


def apart(model, count):
    free = kept_apart(model, [paths(count)])
    return [free[path] for path in paths(count)]


@given(
    st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=6, unique=True).map(sorted),
    st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6),
)
def test_wherever_the_search_goes_the_corners_keep_their_order(deformations, shares):
    within = apart(curve(deformations, lower=0.0), len(deformations))
    moved = [one.lower + share * (min(one.upper, 2.0) - one.lower) for one, share in zip(within, shares, strict=False)]
    assert np.all(np.diff(moved) >= 0.099 * np.diff(deformations) - 1e-15)
    assert moved[0] > 0.0
    assert all(one.lower <= one.value <= one.upper for one in within)


def test_bounds_of_the_user_stay_where_they_are_narrower():
    first, second = apart(curve(CORNERS, lower=0.035, upper=0.11), 2)
    assert (first.lower, first.upper) == (0.035, pytest.approx(0.067))
    assert (second.lower, second.upper) == (pytest.approx(0.073), 0.11)


def test_fixed_corners_stay_fixed():
    assert not set(paths(2)) & set(kept_apart(curve(CORNERS, fixed=True), [paths(2)]))


def test_a_misfit_finds_the_lists_of_its_model(registry, recorded_curve):
    misfit = recorded_curve(CORNERS)
    bounds = dict(zip(misfit.names, zip(*np.exp(misfit.bounds()), strict=True), strict=True))
    assert [bounds[path][0] for path in paths(2)] == pytest.approx([0.022, 0.073])


def test_corners_that_are_off_are_identified(registry, recorded_curve):
    misfit = recorded_curve([1.14 * CORNERS[0], 0.88 * CORNERS[1]])
    found = begin(registry.identifier("sensitivity")(), misfit).advance(60)
    assert [misfit.values(found.point)[path] for path in paths(2)] == pytest.approx(CORNERS, rel=1e-4)


@pytest.fixture
def recorded_curve(registry):
    """The misfit of a model with these corners to a perfect recording of one with the true ones."""

    def make(deformations):
        simulator = Simulator(curve(CORNERS), registry.spring_laws)
        motion = simulator.run(np.arange(301) * 1e-3, initial=toys.initial_state(simulator.model, 1.0), step=5e-4)
        given = curve(deformations, lower=0.0)
        return Misfit(given, {"run": toys.recording(motion)}, registry.spring_laws, registry.observers, simulator.engine)

    return make
