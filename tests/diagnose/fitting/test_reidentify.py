"""The best fit of a model as it is."""

import numpy as np
import pytest

from crashkit.diagnose.fitting import reidentify as module
from crashkit.diagnose.fitting.reidentify import WIDTHS, refine, reidentify, scattered, scattered_by_deviation
from crashkit.diagnose.fitting.search import STEPS, begin, meet
from crashkit.model import Parameter


@pytest.fixture
def far_from(model, misfit, recorded):
    """The misfit of the model with thresholds twice as large as they are, from which steps downhill end elsewhere."""

    def of(true):
        far = model.with_values({path: 2.0 * p.value for path, p in model.free_parameters().items()})
        return misfit(far, slow=recorded(true, 0.9, 1), fast=recorded(true, 1.2, 2))

    return of


def test_the_given_model_is_found_again_from_far_away(workshop, model, far_from):
    assert reidentify(workshop, far_from(model)).normalised == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize(
    ("has_more", "everywhere", "meets", "is_asked"),
    [(False, True, False, False), (True, True, False, True), (True, True, True, False), (True, False, False, False)],
)
def test_it_is_looked_for_everywhere_only_where_something_is_left_that_numbers_may_explain_and_searches_part(
    workshop, model, far_from, has_more, everywhere, meets, is_asked, monkeypatch
):
    asked = []
    found = module._found
    monkeypatch.setattr(module, "_found", lambda finder, misfit: asked.append(finder) or found(finder, misfit))
    monkeypatch.setattr(module, "meet", lambda costs: meets)
    damped = model.with_parameters({"joint.first.rate_coefficient": Parameter(0.3, fixed=True)})
    search = reidentify(workshop, far_from(damped if has_more else model), everywhere)
    assert (search.normalised > 1.5) == has_more
    assert bool(asked) == is_asked


def test_searches_meet_that_leave_the_same_to_a_thousandth():
    assert meet([500.0, 500.2]) and meet([500.2, 500.0])
    assert not meet([500.0, 501.0]) and not meet([501.0, 500.0]) and not meet([500.0])


@pytest.fixture
def fitted(workshop, model, misfit, recorded):
    """The model at its best fit."""
    start = misfit(model, slow=recorded(model, 0.9, 1), fast=recorded(model, 1.2, 2))
    return begin(workshop.identifier, start).advance(STEPS).fitted()


def test_starts_about_a_fit_leave_little_more_and_what_is_little_known_moves_most(fitted):
    start, (_, jacobian) = fitted.start(), fitted.residual_and_jacobian(fitted.start())
    points = [one.start() for one in scattered_by_deviation(fitted, 41)]
    assert np.array_equal(points[0], start)
    moves = np.array(points[1:]) - start
    told = np.sqrt(np.sum((moves @ jacobian.T) ** 2, axis=1) / len(start))
    assert 0.1 < np.median(told) / np.mean(WIDTHS) < 2.0
    assert _left(scattered_by_deviation(fitted, 41)) < 0.1 * _left(scattered(fitted, 41))


def _left(misfits):
    return np.median([one.deviance(one.residual(one.start())) for one in misfits])


def test_where_no_covariance_is_known_starts_are_scattered_alike(fitted, monkeypatch):
    monkeypatch.setattr(module, "tangent", lambda misfit, point: None)
    alike = [one.start() for one in scattered(fitted, 5)]
    assert np.array_equal([one.start() for one in scattered_by_deviation(fitted, 5)], alike)


@pytest.mark.parametrize(("moved", "asked"), [(1.0, True), (1.5, False)])
def test_starts_follow_the_covariance_only_about_what_fits(workshop, fitted, moved, asked, monkeypatch):
    told = []
    monkeypatch.setattr(module, "scattered_by_deviation", lambda misfit, count: told.append(count) or scattered(misfit, count))
    values = {path: moved * value for path, value in fitted.values(fitted.start()).items()}
    refine(workshop.identifier, fitted.with_values(values))
    assert bool(told) == asked
