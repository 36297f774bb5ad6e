"""Several starts: the contract, starts that are far off, outliers, correlated noise."""

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.data.channel_filter import filter_channel
from crashkit.errors import SimulationError
from crashkit.misfit import Misfit
from crashkit.misfit.predictor import Predictor
from crashkit.protocols import Status
from crashkit.registry import load
from crashkit.testing import IdentifierContract, toys
from crashkit_identifiers.multi_start import MultiStart
from crashkit_identifiers.run import run
from crashkit_identifiers.sensitivity import Sensitivity


class TestMultiStart(IdentifierContract):
    start = 0.5

    @pytest.fixture
    def identifier(self):
        return MultiStart()


NINE = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)


def scattered(truth, factors):
    """A start with every parameter off by a factor of its own."""
    values = {path: f * p.value for f, (path, p) in zip(factors, truth.free_parameters().items(), strict=True)}
    return truth.with_values(values)


def exact(truth, start, speeds=(1.0,)):
    registry = load()
    return toys.problem(truth, start, registry.spring_laws, registry.observers, speeds, exact=True)


@pytest.mark.parametrize("seed", range(4))
def test_two_degrees_are_found_from_starts_of_which_single_searches_lose_a_quarter(errors, seed):
    found = run(MultiStart(), exact(NINE, scattered(NINE, np.random.default_rng(seed).uniform(0.5, 1.5, 9))))
    assert found.status is Status.CONVERGED
    assert max(map(abs, errors(found, NINE).values())) < 1e-8


def test_a_start_at_three_times_and_a_third_of_the_values(errors):
    truth = toys.one_degree()
    for factors in ([3.0, 1 / 3, 1 / 3, 3.0], [1 / 3, 3.0, 3.0, 1 / 3]):
        found = run(MultiStart(), exact(truth, scattered(truth, factors)))
        assert max(map(abs, errors(found, truth).values())) < 1e-8


@pytest.fixture
def broken_above(monkeypatch):
    """Lets no model be simulated whose first parameter is above a limit."""
    sound = Predictor.predict_at

    def broken(limit):
        def predict_at(self, values, sensitivities=False):
            if values[0] > limit:
                raise SimulationError("no progress")
            return sound(self, values, sensitivities)

        monkeypatch.setattr(Predictor, "predict_at", predict_at)

    return broken


def test_a_start_that_cannot_be_simulated_gives_way_to_others(errors, broken_above):
    truth = toys.one_degree()
    problem = exact(truth, scattered(truth, [1.3, 1.0, 1.0, 1.0]))
    broken_above(1.25 * problem.parameters(problem.start())[0] / 1.3)
    found = run(MultiStart(), problem)
    assert found.status is Status.CONVERGED
    assert max(map(abs, errors(found, truth).values())) < 1e-8


def test_where_no_start_can_be_simulated_the_search_has_failed(broken_above):
    broken_above(-np.inf)
    assert run(MultiStart(starts=3), exact(toys.one_degree(), toys.one_degree())).status is Status.FAILED


def test_it_says_how_many_starts_it_took():
    truth = toys.one_degree()
    near, far = (run(MultiStart(), exact(truth, scattered(truth, f))) for f in ([0.9] * 4, [3.0, 3.0, 1 / 3, 1 / 3]))
    assert "starts" not in near.parameters.attrs["remarks"]
    assert far.parameters.attrs["remarks"].endswith(" starts were searched from; 1 of them ended here.")


def spoiled(tree, share, size, random):
    """The recording with some readings of the film far off, to one side."""
    film = tree.children["film"].to_dataset(inherit=False)
    away = np.where(random.uniform(size=film["position"].shape) < share, size, 0.0)
    film["position"] = film["position"] + away * film["position_std"].values[None, :, None]
    return tree.assign({"film": xr.DataTree(film)})


def test_outliers_do_not_rule(search):
    truth, registry, random = toys.one_degree(), load(), np.random.default_rng(3)
    clean = search(truth, 0.7, noise=0.01)
    runs = {run: spoiled(tree, 0.08, 40.0, random) for run, tree in clean.recordings.items()}
    dirty = Misfit(clean.model, runs, registry.spring_laws, registry.observers)
    found, without, single = run(MultiStart(), dirty), run(MultiStart(), clean), run(Sensitivity(), dirty)
    std = without.parameters["std"].values
    away, single_away = (
        np.abs(f.parameters["value"].values - without.parameters["value"].values) / std for f in (found, single)
    )
    assert away.max() < 1.0 < 5.0 < single_away.max()
    assert found.parameters["std"].values == pytest.approx(std, rel=0.1)
    spoilt = sum(
        int(np.sum(np.abs(runs[name]["film"]["position"] - clean.recordings[name]["film"]["position"]) > 0)) for name in runs
    )
    assert (
        f"{spoilt} of 802 readings are outliers and were left out (speed_1/film/front_marker)."
        in found.parameters.attrs["remarks"]
    )
    assert found.parameters.attrs["left_out"] == {"speed_1/film/front_marker": pytest.approx(spoilt / 401)}
    assert found.parameters.attrs["normalised_residual"] == pytest.approx(1.0, abs=0.1)
    assert found.parameters.attrs["normalised_residual_of_all"] > 5.0


def test_a_channel_of_which_a_fifth_does_not_fit_is_told(search):
    """The accelerometer's cable breaks: from then on it reads 3000 m s-2 too little."""
    clean, registry = search(toys.one_degree(), 0.9, noise=0.01), load()
    tree = clean.recordings["speed_1"]
    group = tree.children["accelerometer"].to_dataset(inherit=False)
    late = group["time"] > 0.8 * group["time"].max()
    broken = tree.assign({"accelerometer": xr.DataTree(group.assign(acceleration=group["acceleration"] - 3000.0 * late))})
    found = run(MultiStart(), Misfit(clean.model, {"speed_1": broken}, registry.spring_laws, registry.observers))
    attributes = found.parameters.attrs
    assert attributes["left_out"] == {"speed_1/accelerometer/front_sensor": pytest.approx(0.2, abs=0.01)}
    assert attributes["normalised_residual_of_all"] > 10.0 * attributes["normalised_residual"]


def test_a_wrong_model_has_no_outliers(search):
    """Of readings that no values explain, none is left out."""
    clean = search(toys.one_degree(), 0.9, noise=0.01)
    slope = "joint.first.densification_stiffness"
    wrong = clean.model.with_parameters({slope: evolve(clean.model.parameters()[slope], value=3e4, fixed=True)})
    registry = load()
    found = run(MultiStart(), Misfit(wrong, clean.recordings, registry.spring_laws, registry.observers))
    assert found.parameters.attrs["normalised_residual"] > 3.0
    assert "outliers" not in found.parameters.attrs["remarks"]


def filtered(tree, random):
    """The recording with an accelerometer filtered to CFC 60, noise and all."""
    group = tree.children["accelerometer"].to_dataset(inherit=False)
    clean = group["acceleration"].values
    noisy = clean + 5.0 * random.normal(size=clean.shape)
    times = group["time"].values
    smooth = filter_channel(noisy[:, :, 0], times, 60, before=0.0)[:, :, None]
    group["acceleration"] = group["acceleration"].copy(data=smooth)
    pure = filter_channel(random.normal(size=(4001, 1)), np.arange(4001) * (times[1] - times[0]), 60, before=0.0)
    group["acceleration_std"] = ("sensor", np.full(group.sizes["sensor"], 5.0 * float(pure.std())))
    group.attrs["channel_frequency_class"] = 60
    return tree.assign({"accelerometer": xr.DataTree(group)}).drop_nodes("film")


def test_intervals_cover_where_noise_is_filtered(search):
    """Readings of a filtered channel are not independent: counted as if they were, intervals would be half as wide."""
    truth, registry, random = toys.one_degree(), load(), np.random.default_rng(6)
    clean, inside = search(truth, 1.0).recordings, []
    for _ in range(25):
        runs = {name: filtered(tree, random) for name, tree in clean.items()}
        found = run(MultiStart(least_drop=1e-3), Misfit(truth, runs, registry.spring_laws, registry.observers)).parameters
        values = [parameter.value for parameter in truth.free_parameters().values()]
        inside += list((found["interval_lower"].values <= values) & (values <= found["interval_upper"].values))
    assert 86 <= sum(inside) <= 100  # of 95 expected, 4 sigma


def test_what_is_known_beforehand_is_believed(search):
    truth = toys.two_degrees()
    found = run(MultiStart(prior=0.02), search(truth, 0.9, noise=0.03))
    slope = "joint.second.densification_stiffness"  # which these recordings do not see
    start = 0.9 * truth.parameters()[slope].value
    assert found.values[slope] == pytest.approx(start, rel=1e-3)
    assert float(found.parameters["std"].sel(parameter=slope)) == pytest.approx(0.02 * start, rel=0.05)


def test_a_model_with_nothing_free_has_nothing_to_find(search):
    problem = search(toys.one_degree())
    fixed = problem.model.with_parameters({p: evolve(v, fixed=True) for p, v in problem.model.free_parameters().items()})
    registry = load()
    found = run(MultiStart(), Misfit(fixed, problem.recordings, registry.spring_laws, registry.observers))
    assert found.values == {} and found.status is Status.CONVERGED
