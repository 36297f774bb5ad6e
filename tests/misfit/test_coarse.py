"""Fewer instants for first guesses: what they keep, and that they say nearly the same."""

import numpy as np
import pytest

from crashkit.misfit import Misfit
from crashkit.misfit.coarse import INSTANTS
from crashkit.misfit.thin import FILTER_MARGIN, SEARCH_INTERVAL
from crashkit.registry import load
from crashkit.testing import toys


@pytest.fixture(scope="module")
def problem() -> Misfit:
    registry, truth = load(), toys.one_degree()
    return toys.problem(truth, toys.start_from(truth, 0.8), registry.spring_laws, registry.observers, exact=True)


def test_every_so_many_samples_of_each_channel_are_kept(problem):
    coarse = problem.coarse
    for few, group in zip(coarse.groups, problem.groups, strict=True):
        assert INSTANTS <= len(few.times) < 2 * INSTANTS
        assert set(few.times) <= set(group.times)
        assert few.recorded == pytest.approx(group.recorded[np.isin(group.times, few.times)])
    assert coarse.names == problem.names
    assert coarse.start() == pytest.approx(problem.start())
    assert coarse.independent_samples < problem.independent_samples / 3.0


def test_it_is_made_once(problem):
    assert problem.coarse is problem.coarse


def test_it_says_nearly_the_same(problem):
    truth = problem.scaled(np.array([p.value for p in toys.one_degree().free_parameters().values()]))
    assert np.abs(problem.coarse.residual(truth)).max() < 1e-2  # of a standard deviation: long steps
    few, many = (np.mean(np.square(m.residual(m.start()))) for m in (problem.coarse, problem))
    assert few == pytest.approx(many, rel=0.1)


def filtered(tree, frequency_class):
    changed = tree.copy()
    changed["accelerometer"].attrs["channel_frequency_class"] = frequency_class
    return changed


@pytest.mark.parametrize(("frequency_class", "instants"), [(0, 101), (60, 401), (180, 401)])
def test_a_filtered_channel_keeps_what_its_filter_needs(problem, frequency_class, instants):
    runs = {run: filtered(tree, frequency_class) for run, tree in problem.recordings.items()}
    registry = load()
    coarse = Misfit(problem.model, runs, registry.spring_laws, registry.observers).coarse
    assert {group.name: len(group.times) for group in coarse.groups} == {"film": 101, "accelerometer": instants}


@pytest.fixture
def fast(recorded, model):
    """A run sampled at 10 kHz, its accelerometer through a filter of a class, and the misfit of the model that made it."""

    def of(frequency_class):
        registry = load()
        run = filtered(recorded(model, interval=1e-4), frequency_class)
        return Misfit(model, {"run": run}, registry.spring_laws, registry.observers)

    return of


def accelerometer(misfit):
    return next(group for group in misfit.groups if group.name == "accelerometer")


@pytest.mark.parametrize(("frequency_class", "interval"), [(60, 8e-4), (180, 4e-4)])
def test_filtered_samples_are_no_further_apart_than_their_filter_bears(fast, frequency_class, interval):
    group = accelerometer(fast(frequency_class).coarse)
    assert np.diff(group.times) == pytest.approx(interval)
    assert interval <= 1.0 / (FILTER_MARGIN * frequency_class) < 2.0 * interval
    assert group.dataset.attrs["channel_frequency_class"] == frequency_class


def test_a_channel_behind_an_open_filter_becomes_means(fast):
    misfit = fast(1000)
    group, before = accelerometer(misfit.coarse), accelerometer(misfit)
    assert group.dataset.attrs["channel_frequency_class"] == 0
    assert np.diff(group.times).min() >= SEARCH_INTERVAL - 1e-9
    (noise,), (sample,) = ({channel.noise for channel in one.channels} for one in (group, before))
    assert noise.correlation == 1.0 and 0.2 * sample.std < noise.std < sample.std
    left = misfit.coarse.residual(misfit.coarse.start())
    assert np.sqrt(np.mean(left**2)) < 1.2  # the model that made it, unfiltered as the means are


def test_a_single_sample_is_left_alone(problem):
    registry = load()
    runs = {run: tree.isel(time=slice(40, 41)) for run, tree in problem.recordings.items()}
    single = Misfit(problem.model, runs, registry.spring_laws, registry.observers)
    assert [len(group.times) for group in single.coarse.groups] == [1] * len(single.groups)


def test_few_samples_are_left_alone(problem):
    runs = {run: tree.isel(time=slice(None, None, 4)) for run, tree in problem.recordings.items()}
    registry = load()
    few = Misfit(problem.model, runs, registry.spring_laws, registry.observers)
    assert [len(group.times) for group in few.coarse.groups] == [len(group.times) for group in few.groups]


def test_missing_readings_are_no_residuals(problem):
    def hidden(tree):
        changed = tree.copy()
        changed["film"]["position"][::8] = np.nan
        return changed

    registry = load()
    runs = {run: hidden(tree) for run, tree in problem.recordings.items()}
    coarse = Misfit(problem.model, runs, registry.spring_laws, registry.observers).coarse
    assert len(coarse.residual(coarse.start())) == sum(channel.samples for channel in coarse.channels) == 50 + 101


def test_the_first_part_of_the_time_is_that_part_of_every_residual(problem):
    early = problem.up_to(0.5)
    end = 0.5 * max(group.times[-1] for group in problem.groups)
    for part, group in zip(early.groups, problem.groups, strict=True):
        assert part.times.tolist() == group.times[group.times <= end].tolist()
        assert part.recorded.tolist() == group.recorded[: len(part.times)].tolist()
    assert early.names == problem.names
    assert early.independent_samples == pytest.approx(0.5 * problem.independent_samples, rel=0.05)


def test_an_instrument_that_begins_later_has_no_part_in_it(problem):
    assert problem.up_to(1e-6).groups == ()


def test_a_run_that_is_seen_only_later_has_no_part_in_it():
    registry, truth = load(), toys.one_degree()
    start = toys.start_from(truth, 0.8)
    both = toys.problem(truth, start, registry.spring_laws, registry.observers, speeds=(1.0, 1.2))
    late = {run: tree.isel(time=slice(250, None)) if run == "speed_1.2" else tree for run, tree in both.recordings.items()}
    early = Misfit(start, late, registry.spring_laws, registry.observers).up_to(0.5)
    alone = toys.problem(truth, start, registry.spring_laws, registry.observers).up_to(0.5)
    assert {group.run for group in early.groups} == {"speed_1"}
    assert early.residual_and_jacobian(early.start())[0] == pytest.approx(alone.residual(alone.start()), abs=1e-9)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.55])
@pytest.mark.parametrize("frequency_class", [60, 180])
def test_the_first_part_of_a_filtered_channel_sees_as_far_ahead_as_its_filter(problem, frequency_class, share):
    registry = load()
    runs = {run: filtered(tree, frequency_class) for run, tree in problem.recordings.items()}
    believed = Misfit(problem.model, runs, registry.spring_laws, registry.observers)
    read = believed.predictor.predict_at(believed.parameters(believed.start()))
    for group, one in zip(believed.groups, read, strict=True):
        runs[group.run][group.name][group.observer.quantity].values[...] = one.samples.reshape(group.recorded.shape)[..., None]
    exact = Misfit(problem.model, runs, registry.spring_laws, registry.observers)
    early = exact.up_to(share)
    assert np.abs(early.residual(early.start())).max() < 0.05
    assert early.independent_samples == pytest.approx(share * exact.independent_samples, rel=0.05)
