"""Predicted curves: their bands hold what other noise would have led to, and open where nothing is known."""

import numpy as np
import pytest

from crashkit.misfit.bands import predicted_curves
from crashkit.testing import toys


@pytest.fixture
def identified(registry):
    """A misfit and what the default method makes of it."""

    def identify(misfit):
        method = registry.identifier("sensitivity")()
        state = method.start(misfit)
        while state.status.name == "RUNNING":
            state = method.step(misfit, state)
        return misfit, method.finish(misfit, state)

    return identify


def test_the_band_holds_the_true_curve(misfit, model, recorded, identified):
    """Over 40 noises, 95 % of the bands at each instant hold what was really there."""
    exact, hits = recorded(model), []
    for seed in range(40):
        fitted, result = identified(misfit(model, run=toys.noisy(exact, 0.05, np.random.default_rng(seed))))
        film = predicted_curves(fitted, fitted, result)["run/film"]
        true = fitted.predictor.predict({n: p.value for n, p in model.free_parameters().items()})
        number = next(n for n, group in enumerate(fitted.groups) if group.name == "film")
        samples = true[number].samples
        hits.append(((film["lower"].values <= samples) & (samples <= film["upper"].values)).mean())
    assert 0.88 < np.mean(hits) < 0.99


def test_a_threshold_that_was_never_reached_opens_the_band_of_a_faster_test(misfit, model, recorded, identified):
    """At half the speed the plateau does not end; where it ends is at least as far as that, and matters at full speed."""
    slow = toys.noisy(recorded(model, speed=0.5), 0.01, np.random.default_rng(0))
    fitted, result = identified(misfit(model, slow=slow))
    both = misfit(model, slow=slow, fast=recorded(model))
    curves = predicted_curves(fitted, both, result)
    known, open_ = ((curves[f"{run}/film"]["upper"] - curves[f"{run}/film"]["lower"]).max() for run in ("slow", "fast"))
    assert float(open_) > 20.0 * float(known)
    fast = curves["fast/film"]
    assert ((fast["lower"] <= fast["recorded"]) & (fast["recorded"] <= fast["upper"])).mean() > 0.9


def test_curves_know_their_unit_and_their_axis(misfit, model, recorded, identified):
    fitted, result = identified(misfit(model, run=toys.noisy(recorded(model), 0.01, np.random.default_rng(0))))
    film = predicted_curves(fitted, fitted, result)["run/film"]
    assert (film.attrs["quantity"], film.attrs["units"]) == ("position", "m")
    assert film["axis"].values.tolist() == ["x"] * film.sizes["channel"]
