"""Numbers far from the given ones, begun again from there."""

import pytest

from crashkit.diagnose.fitting.back_to_given import begun_at_given, begun_from_given
from crashkit.diagnose.fitting.search import begin
from crashkit.testing import toys


@pytest.fixture
def identified(workshop, misfit, recorded):
    """The given misfit, and the fit of the true model."""
    two = toys.two_degrees()
    given = misfit(two, slow=recorded(two, 0.9, 1), fast=recorded(two, 1.2, 2))
    return given, begin(workshop.identifier, given).advance(40)


@pytest.mark.parametrize("joint", ["first", "second"])
def test_a_joint_that_was_driven_far_away_comes_back(workshop, identified, joint):
    given, best = identified
    path = f"joint.{joint}.densification_deformation"
    values = given.values(best.point)
    caught = begin(workshop.identifier, given.with_values({**values, path: 0.3 * values[path]}))
    assert begun_from_given(caught, given).deviance == pytest.approx(best.deviance, abs=1.0)
    assert begun_at_given(caught, given, joint).deviance == pytest.approx(best.deviance, abs=1.0)
    assert begun_at_given(caught, given, "no_such") is caught


def test_what_the_given_values_do_not_better_stays(identified):
    given, best = identified
    assert begun_from_given(best, given).deviance == pytest.approx(best.deviance, abs=1e-3)
