"""A model fitted again without what was found."""

import pytest

from crashkit.diagnose.fitting.rebuild import _earlier_paths, alone_again, rebuild
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


def test_two_findings_in_one_joint_keep_their_numbers_whichever_stands_in_its_law(workshop, misfit, recorded, model, claim):
    base = begin(workshop.identifier, misfit(model, run=recorded(model)))
    peak = claim(base.misfit, "peak_load", "bump", peak_force=4e4, peak_deformation=0.05)
    folds = claim(peak.search.misfit, "progressive_folding", "sine", amplitude=8e3, fold_length=0.1, onset=0.1)
    true = folds.search.misfit
    told = begin(workshop.identifier, misfit(true.model, run=recorded(true.model)))
    turned = rebuild(workshop, begin(workshop.identifier, told.misfit.with_model(model, workshop.laws)), [folds, peak], told)
    assert turned.misfit.model.joint("first").law == "crush_plateau + folding"
    assert turned.values["joint.first.amplitude"] == pytest.approx(8e3, rel=0.15)
    assert turned.values["joint.first_peak_load.peak_force"] == pytest.approx(4e4, rel=0.05)


def test_a_claim_about_more_sensors_than_before_keeps_the_paths_of_its_numbers(misfit, recorded, model, claim):
    run = recorded(model)
    all_of_them = claim(misfit(model, run=run), "rotation", "rocking").proposal
    one = claim(misfit(model, run=run.drop_nodes("accelerometer")), "rotation", "rocking").proposal
    assert len(one.parameters) < len(all_of_them.parameters)
    assert _earlier_paths(all_of_them, one) == {}
    assert _earlier_paths(one, one) == dict(zip(one.parameters, one.parameters, strict=True))
