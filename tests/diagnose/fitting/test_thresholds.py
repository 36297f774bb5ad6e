"""Thresholds that a search does not reach."""

import pytest
from attrs import evolve

from crashkit.diagnose.fitting import thresholds
from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.fitting.thresholds import awake, wakened

THRESHOLD = "joint.first.densification_deformation"


@pytest.fixture
def fit(workshop, model, misfit, recorded):
    """A fit of recordings of the model, begun where that threshold has another value than it has."""

    def of(threshold):
        here = misfit(model, slow=recorded(model, 0.9, 1), fast=recorded(model, 1.2, 2))
        return begin(workshop.identifier, here.with_values({THRESHOLD: threshold})).advance(60)

    return of


def test_a_threshold_that_is_never_reached_is_begun_again_where_it_is(workshop, model, fit):
    true = model.free_parameters()[THRESHOLD].value
    asleep = fit(5.0 * true)
    assert asleep.misfit.values(asleep.point)[THRESHOLD] == pytest.approx(5.0 * true)
    assert asleep.normalised > 1.5
    found = wakened(workshop, asleep)
    assert found.misfit.values(found.point)[THRESHOLD] == pytest.approx(true, rel=0.01)
    assert found.normalised == pytest.approx(1.0, abs=0.05)


def test_a_fit_that_reaches_all_its_thresholds_stays(workshop, model, fit):
    here = fit(model.free_parameters()[THRESHOLD].value)
    assert wakened(workshop, here) is here


@pytest.mark.parametrize(("share", "times"), [(0.9999, 1), (0.5, 8)])
def test_waking_ends_where_it_hardly_gains(fit, workshop, monkeypatch, share, times):
    """A load on a tie that no run crushes left a little less each time, without end."""
    begun = []

    def a_little_lower(search, starts):
        begun.append(search)
        lower = search.state.cost * share if len(begun) < 8 else search.state.cost
        return evolve(search, state=evolve(search.state, cost=lower))

    monkeypatch.setattr(thresholds, "begun_again", a_little_lower)
    found = wakened(workshop, fit(5.0))
    assert len(begun) == times
    assert found.state.cost == pytest.approx(begun[-1].state.cost, rel=1e-3)


def test_where_the_given_threshold_is_asleep_that_of_a_fit_is_taken(model, misfit, recorded, workshop):
    true = model.free_parameters()[THRESHOLD].value
    fitted = begin(workshop.identifier, misfit(model, slow=recorded(model, 0.9, 3), fast=recorded(model, 1.2, 4))).advance(20)
    known = fitted.misfit.values(fitted.point)[THRESHOLD]
    far, near = (fitted.misfit.with_values({THRESHOLD: factor * true}) for factor in (5.0, 1.1))
    taken = [awake(workshop, given, fitted) for given in (far, near)]
    thresholds = [one.values(one.start())[THRESHOLD] for one in taken]
    assert thresholds == pytest.approx([known, 1.1 * true])
