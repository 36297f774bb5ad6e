"""How well runs foretell others: the spread of predictions that the fitted numbers allow."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.diagnose.fitting.search import begin
from crashkit.diagnose.show.expected_error import expected_error
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.model import InstrumentErrors, Parameter

END = "joint.first.densification_deformation"
AFTER = "joint.first.densification_stiffness"


def fitted(workshop, misfit, model, runs):
    search = begin(workshop.identifier, misfit(model, **runs).with_prior(0.3)).advance(40)
    return search.fitted()


def test_runs_that_tell_every_number_foretell_to_the_noise(workshop, model, misfit, recorded):
    final = fitted(workshop, misfit, model, {"slow": recorded(model, 0.9, 1), "fast": recorded(model, 1.3, 2)})
    expected, _ = expected_error(final, misfit(final.model, held=recorded(model, 1.35, 3)), 0.3)
    assert 1.0 < expected < 1.05


def test_what_only_the_held_out_run_reaches_is_not_foretold_and_is_named(workshop, model, misfit, recorded):
    """The fitted run stays on the plateau."""
    final = fitted(workshop, misfit, model, {"slow": recorded(model, 0.5, 1)})
    held = misfit(final.model, held=recorded(model, 1.3, 3))
    (vague, untold), (sharp, _) = (expected_error(final, held, believed) for believed in (0.3, 0.03))
    assert untold in (END, AFTER)
    assert vague > 5.0 and vague > 2.0 * sharp


def test_it_is_what_models_leave_that_the_fitted_runs_cannot_tell_apart(workshop, model, misfit, recorded):
    """Against numbers drawn from the posterior, each predicting a recording of the fitted model."""
    final = fitted(workshop, misfit, model, {"slow": recorded(model, 0.9, 1), "fast": recorded(model, 1.2, 2)})
    held = misfit(final.model, held=recorded(final.model, 1.3, 3))
    jacobian = final.residual_and_jacobian(final.start())[1]
    random, n = np.random.default_rng(0), held.independent_samples
    draws = random.multivariate_normal(final.start(), np.linalg.inv(jacobian.T @ jacobian), 40)
    clean = held.discrepancy(held.start())
    left = np.mean([np.sum((held.discrepancy(draw) - clean) ** 2) for draw in draws])
    expected, _ = expected_error(final, held, 0.3)
    assert n * (expected**2 - 1.0) == pytest.approx(left, rel=0.5)


def test_what_nobody_believes_and_no_run_tells_makes_nothing_uncertain(model, misfit, recorded):
    """A sensor that reads along one axis does not show how much of that it mixes into others."""
    axes = InstrumentErrors("accelerometer", "mass", {"transverse_x": Parameter(0.0)})
    one = misfit(evolve(model, instruments=(axes,)), run=recorded(model))
    expected, _ = expected_error(one, one, 0.3)
    assert 1.0 < expected < 1.05


def test_where_there_is_nothing_to_know_nothing_is_uncertain(model, misfit, recorded):
    fixed = model.with_parameters({path: evolve(p, fixed=True) for path, p in model.free_parameters().items()})
    one = misfit(fixed, run=recorded(model))
    assert expected_error(one, one, 0.3) == (1.0, "")


@pytest.mark.parametrize("broken", ["raises", "overflows"])
def test_where_derivatives_cannot_be_had_nothing_is_promised(model, misfit, recorded, monkeypatch, broken):
    one = misfit(model, run=recorded(model))
    residual, jacobian = one.residual_and_jacobian(one.start())

    def derivatives(self, scaled):
        if broken == "raises":
            raise SimulationError("it does not move")
        return residual, np.full_like(jacobian, np.inf)

    monkeypatch.setattr(Misfit, "residual_and_jacobian", derivatives)
    expected, untold = expected_error(one, one, 0.3)
    assert np.isnan(expected) and untold == ""


def test_a_threshold_just_ahead_is_no_certainty(workshop, model, misfit, recorded):
    """Neither run reaches it where it was believed to be; the held-out one would if it came a little sooner."""
    deeper = model.with_values({END: 2.1})
    final = fitted(workshop, misfit, deeper, {"slow": recorded(deeper, 0.5, 1)})
    held = misfit(final.model, held=recorded(deeper, 1.0, 3))
    index = held.names.index(END)
    assert not held.residual_and_jacobian(held.start())[1][: len(held.discrepancy(held.start())), index].any()
    expected, untold = expected_error(final, held, 0.3)
    assert untold == END and expected > 2.0
