"""A model fitted again without what was found."""

import pytest

from crashkit.diagnose.fitting.rebuild import alone_again
from crashkit.diagnose.fitting.search import begin
from crashkit.testing import toys

CRUSH, PATH = "joint.first.crush_force", "joint.first.elastic_stiffness"


@pytest.fixture
def stuck(workshop, misfit, recorded):
    """A fit that was given up far from the true numbers, and the misfit at them."""
    true = toys.one_degree()
    own = misfit(true, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2))
    value = true.parameters()[PATH].value
    return begin(workshop.identifier, own.with_values({PATH: 6.0 * value})), own


def test_a_claim_may_show_that_the_model_alone_was_in_a_local_optimum(stuck):
    search, true = stuck
    again = alone_again(search, [true.with_values({CRUSH: 1.1 * true.model.parameters()[CRUSH].value}), search.fitted()])
    assert again.normalised < 1.2 < 2.0 < search.normalised


def test_what_no_claim_improves_stays(stuck):
    search, true = stuck
    best = begin(search.identifier, true).advance(40)
    assert alone_again(best, [search.fitted()]).deviance == pytest.approx(best.deviance, abs=0.1)
    assert alone_again(best, []) is best
