"""Steps of the integration are as short as the noise asks, and no shorter."""

import numpy as np
import pytest

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit, fine_step
from crashkit.misfit.coarse import COARSER
from crashkit.misfit.fine_step import LITTLE
from crashkit.misfit.predictor import STEP


def stiff(model, factor):
    """The same model with every spring stiffer: it swings faster."""
    values = {p: factor * v.value for p, v in model.parameters().items() if p.endswith(("stiffness", "crush_force"))}
    return model.at(values)


def error(misfit, step):
    """The largest error of a channel, relative to its noise."""
    exact = misfit.with_step(2e-6)
    difference = misfit.with_step(step).residual(misfit.start()) - exact.residual(exact.start())
    samples = np.array([channel.samples for channel in misfit.channels])
    return float(np.sqrt(np.max(misfit.channel_sums(difference) / samples)))


@pytest.fixture
def seldom(recorded, model, misfit):
    """What is read every 5 ms of a model whose springs are so many times stiffer."""

    def read(factor):
        stiffer = stiff(model, factor)
        run = recorded(stiffer, interval=5e-3, end=0.1)
        return misfit(stiffer, run=run)

    return read


def test_a_slow_model_keeps_the_usual_step(seldom):
    assert fine_step(seldom(1.0)) == STEP


@pytest.mark.parametrize("factor", [3e3, 3e4])
def test_a_fast_model_gets_a_step_whose_error_is_below_the_noise(seldom, factor):
    misfit = seldom(factor)
    step = fine_step(misfit)
    assert step < STEP
    assert error(misfit, STEP) > LITTLE
    assert error(misfit, step) < LITTLE


def test_what_is_read_often_is_still_read_between_in_steps_as_short_as_the_noise_asks(recorded, model, misfit):
    """Halving a step that the readings cut short anyway changes nothing, and says nothing."""
    fast, interval = stiff(model, 3e4), 2e-4
    read = misfit(fast, run=recorded(fast, interval=interval, end=0.1))
    step = fine_step(read)
    assert step < interval < STEP
    assert error(read, STEP) > LITTLE
    assert error(read, step) < LITTLE


@pytest.mark.parametrize("factor", [1.0, 3e3, 3e4])
def test_few_instants_of_densely_sampled_readings_are_simulated_to_their_noise(recorded, model, misfit, factor):
    """The steps of the integration were short only because the samples were."""
    fast = stiff(model, factor)
    coarse = misfit(fast, run=recorded(fast, interval=1e-4, end=0.1)).coarse
    assert error(coarse, coarse.step) < 1.0
    assert (error(coarse, COARSER * STEP) > 1.0) == (factor > 1e4)


def test_a_model_that_cannot_be_simulated_keeps_its_step(seldom, monkeypatch):
    def fail(self, scaled):
        raise SimulationError("the motion is not finite")

    monkeypatch.setattr(Misfit, "residual", fail)
    assert fine_step(seldom(3e4)) == STEP
