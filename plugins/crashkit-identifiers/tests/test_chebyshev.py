"""Force surfaces: the contract of the method, and the surfaces against the forces that they stand for."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.chebyshev import Chebyshev
from crashkit_identifiers.force_surface import FLAT, _heights, _scattered, interpolated, readings_of
from crashkit_identifiers.measured import measured_motions

SPEEDS = (0.7, 1.0, 1.3, 1.6)


class TestChebyshev(IdentifierContract):
    """Masses stay as they are, so the second toy, whose rear mass is wanted, is not found."""

    recovers = ("one_degree",)
    accuracy = 1e-2

    @pytest.fixture
    def identifier(self):
        return Chebyshev()


def spring(deformation):
    """N, of the reference (eq 40)."""
    force = np.interp(deformation, [0.0, 0.2, 0.6, 2.0], [0.0, 0.24, 0.24, 0.24 + 1.2 * 1.4])
    return toys.STIFFNESS * force


@pytest.fixture(scope="module")
def problem(search):
    return search(toys.one_degree(), speeds=SPEEDS)


@pytest.mark.parametrize(("form", "degree", "accuracy"), [("direct", 12, 0.01), ("direct", 8, 0.01), ("scattered", 8, 0.04)])
def test_a_surface_is_the_force_where_it_was_measured(problem, form, degree, accuracy):
    surface = Chebyshev(form=form, degree=degree).start(problem).surfaces["first"]
    states = 0.5 * (surface.readings + 1.0) * (surface.high - surface.low) + surface.low
    away = surface.force(*states.T) - spring(states[:, 0])
    assert np.sqrt(np.mean(away**2)) < accuracy * toys.STIFFNESS


def test_a_surface_holds_between_the_speeds_that_it_was_measured_at(problem):
    table = Chebyshev().start(problem).surfaces["first"].table()
    away = abs(table["force"] - spring(table["deformation"].values)[:, None]) / toys.STIFFNESS
    inside = ~table["extrapolated"]
    assert 0.4 < float(inside.mean()) < 0.9
    assert float(away.where(inside).median()) < 0.02
    assert float(away.where(~inside).max()) > float(away.where(inside).max())


def test_what_no_reading_surrounds_is_called_extrapolated(problem):
    surface = Chebyshev().start(problem).surfaces["first"]
    assert not surface.is_extrapolated(np.array([0.5]), np.array([9.0]))[0]
    assert surface.is_extrapolated(np.array([1.5]), np.array([15.0]))[0]
    assert surface.is_extrapolated(np.array([0.01]), np.array([0.0]))[0]


def test_a_surface_says_how_it_was_found(problem):
    direct, scattered = (Chebyshev(form=form).start(problem).surfaces["first"] for form in ("direct", "scattered"))
    assert direct.choice.startswith("least squares with a ridge of")
    assert direct.choice.endswith("chosen by leaving out one run after the other")
    assert scattered.choice.startswith("80 readings interpolated at 15 by 15 points")


def test_the_scattered_form_is_exact_on_a_polynomial():
    nodes = np.random.default_rng(0).uniform(-1.0, 1.0, (400, 2))
    values, share = _scattered(nodes, 1.0 + nodes @ [2.0, -3.0], np.array([[0.1, 0.2], [-0.3, 0.4], [5.0, 5.0]]))
    assert values[:2] == pytest.approx([1.0 + 0.2 - 0.6, 1.0 - 0.6 - 1.2])
    nearest = nodes[np.argmin(np.linalg.norm(nodes - 5.0, axis=1))]
    assert values[2] == pytest.approx(1.0 + nearest @ [2.0, -3.0])
    assert share == pytest.approx(2.0 / 3.0)


def test_a_flat_triangle_is_not_interpolated_in():
    flat = np.array([[[0.0, 0.0], [1.0, 0.0], [0.5, 0.5 * FLAT]]])
    assert _heights(flat)[0] == pytest.approx(0.5 * FLAT)
    assert _heights(np.array([[[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]]]))[0] == pytest.approx(2.4)


def test_two_joints_between_the_same_bodies_cannot_be_told_apart_at_an_instant(problem):
    readings = readings_of(problem, measured_motions(problem), 20)
    both = {"first": readings.along["first"], "twin": readings.along["first"]}
    twins = evolve(readings, states={**readings.states, "twin": readings.states["first"]}, along=both)
    with pytest.raises(CrashkitError, match="expected joints whose forces the motion tells apart, found first, twin"):
        interpolated(twins, 2, 15)


def test_an_unknown_form_is_refused():
    with pytest.raises(CrashkitError, match="chebyshev: expected a form of direct, scattered, found spline"):
        Chebyshev(form="spline")
