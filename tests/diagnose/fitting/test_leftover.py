"""What a model leaves of the recordings, judged by the channels whose noise is told."""

import numpy as np
import pytest

from crashkit.diagnose.fitting.leftover import is_all_told, leaves_something, normalised

STIFFNESS = "joint.first.elastic_stiffness"


def filtered(group):
    """As laboratories give it: nobody states its noise."""
    return group.drop_vars("acceleration_std").assign_attrs(channel_frequency_class=180)


@pytest.fixture
def wrong(model):
    """The model with a joint that is too soft."""
    return model.with_values({STIFFNESS: 0.5 * model.parameters()[STIFFNESS].value})


def test_a_channel_whose_noise_nobody_states_is_no_witness(misfit, recorded, model, wrong):
    run = recorded(model, accelerometer=filtered)
    right, off = misfit(model, run=run), misfit(wrong, run=run)
    assert normalised(right, told_only=True) == pytest.approx(1.0, abs=0.1)
    assert not leaves_something(right)
    assert normalised(off, told_only=True) > 2.0
    assert leaves_something(off)
    assert is_all_told(right)
    assert not is_all_told(off)


def test_few_channels_do_not_speak_for_all(misfit, recorded, model):
    """Of two, the one whose noise is told has a tenth of the samples."""

    def rare(film):
        return film.isel(time=slice(None, None, film.sizes["time"] // 4))

    assert is_all_told(misfit(model, run=recorded(model, film=rare)))
    assert not is_all_told(misfit(model, run=recorded(model, film=rare, accelerometer=filtered)))


def test_the_residual_of_all_channels_is_that_of_their_samples_together(misfit, recorded, wrong, model):
    off = misfit(wrong, run=recorded(model))
    residual = off.residual(off.start())[: off.sample_count]
    assert normalised(off, told_only=False) == pytest.approx(np.sqrt(residual @ residual / off.independent_samples))


def test_without_a_witness_nothing_is_left(misfit, recorded, model, wrong):
    run = recorded(model, accelerometer=filtered)
    blind = misfit(wrong, run=run).without_sensor("film", "front_marker")
    assert normalised(blind, told_only=True) == 0.0
    assert not leaves_something(blind)


@pytest.mark.parametrize(("samples", "is_left"), [(8, False), (600, True)])
def test_few_samples_may_leave_a_fifth_more_than_their_noise(misfit, recorded, model, samples, is_left):
    def louder(film):
        few = film.isel(time=np.linspace(0, film.sizes["time"] - 1, min(samples, film.sizes["time"])).astype(int))
        return few.assign(position_std=few["position_std"] / 1.3)

    one = misfit(model, run=recorded(model, film=louder)).without_sensor("accelerometer", "front_sensor")
    assert leaves_something(one) is is_left
