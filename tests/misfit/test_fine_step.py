"""Steps of the integration are as short as the noise asks, and no shorter."""

import numpy as np
import pytest
from attrs import evolve

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit, bears_step, fine_step, predictor
from crashkit.misfit.coarse import COARSER
from crashkit.misfit.fine_step import LITTLE, LONGEST, STRIDE
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


def test_a_slow_model_is_simulated_in_steps_of_a_few_instants(recorded, model, misfit):
    slow = misfit(model, run=recorded(model, interval=2e-4))
    assert fine_step(slow) == STRIDE * slow.predictor.usual_gap == pytest.approx(8e-4)


def test_steps_that_readings_cut_short_anyway_are_asked_for_no_longer(seldom, monkeypatch):
    """As in space: a longer one would be as good as a third of it, and say nothing."""
    monkeypatch.setattr(predictor.Predictor, "_steps_end_at_all", True)
    read = seldom(3e3)
    assert read.predictor.longest_step == pytest.approx(5e-3)
    assert error(read, fine_step(read)) < 1.5 * LITTLE < error(read, 5e-3)


@pytest.mark.parametrize("factor", [3e3, 3e4])
@pytest.mark.parametrize("interval", [5e-3, 2e-4])
def test_a_fast_model_gets_a_step_whose_error_is_little_beside_the_noise(recorded, model, misfit, factor, interval):
    """Whether its readings are seldom or so often that several lie within a step."""
    fast = stiff(model, factor)
    read = misfit(fast, run=recorded(fast, interval=interval, end=0.1))
    step = fine_step(read)
    assert step < min(STRIDE * interval, LONGEST)
    assert error(read, min(STRIDE * interval, LONGEST)) > LITTLE
    assert error(read, step) < 1.5 * LITTLE
    assert bears_step(read.with_step(step)) and not bears_step(read.with_step(20.0 * step))


@pytest.mark.parametrize("factor", [1.0, 3e3, 3e4])
def test_few_instants_of_densely_sampled_readings_are_simulated_to_their_noise(recorded, model, misfit, factor):
    """The steps of the integration were short only because the samples were."""
    fast = stiff(model, factor)
    coarse = misfit(fast, run=recorded(fast, interval=1e-4, end=0.1)).coarse
    assert error(coarse, coarse.step) < 1.0
    assert (error(coarse, COARSER * STEP) > 1.0) == (factor > 1.0)


def quieter(misfit, trusted):
    """The misfit with a millionth of the noise."""

    def quiet(channel):
        return evolve(channel, noise=evolve(channel.noise, std=1e-6 * channel.noise.std, trusted=trusted))

    return misfit._with(groups=[evolve(group, channels=tuple(map(quiet, group.channels))) for group in misfit.groups])


def test_a_model_that_leaves_much_more_than_the_noise_gets_a_step_for_what_it_leaves(recorded, model, misfit):
    """A filtered channel without a noise level may look as if it had next to none."""
    fast = stiff(model, 3e4)
    read = misfit(fast, run=recorded(fast, interval=2e-4, end=0.1))
    quiet = [quieter(read, trusted) for trusted in (False, True)]
    off, told = (one.with_values({path: 1.2 * v for path, v in read.values(read.start()).items()}) for one in quiet)
    left = float(np.sqrt(np.mean(off.residual(off.start()) ** 2)))
    step = fine_step(off)
    assert left > 1e4
    assert error(off, step) < 3e-3 * left
    assert fine_step(told) < 0.5 * step  # a noise that is told is believed


def test_a_model_that_cannot_be_simulated_gets_a_short_step(seldom, monkeypatch):
    def fail(self, scaled):
        raise SimulationError("the motion is not finite")

    monkeypatch.setattr(Misfit, "residual", fail)
    assert fine_step(seldom(3e4)) < STEP
