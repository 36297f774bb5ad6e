"""Thinner recordings say as much."""

import numpy as np
import pytest

from crashkit.data.channel_filter import filter_channel
from crashkit.misfit.thin import SEARCH_INTERVAL, thinned


@pytest.fixture
def quantities(registry):
    return {name: observer.quantity for name, observer in registry.observers.items()}


@pytest.fixture
def run(recorded, model, changed):
    """Film at 1 kHz beside an accelerometer at 10 kHz."""
    recording = recorded(model, interval=1e-4)
    return changed(recording, "film", lambda dataset: dataset.isel(time=slice(None, None, 10)))


def noisy(dataset):
    noise = np.random.default_rng(5).normal(0.0, 1.0, dataset["acceleration"].shape)
    return dataset.assign(acceleration=dataset["acceleration"] + noise)


def test_a_white_channel_is_averaged_about_the_samples_that_stay(run, quantities):
    """Over a block of five, and less a share of how the blocks beside it differ."""
    before = run["accelerometer"].to_dataset(inherit=False)
    after = thinned(run, quantities)["accelerometer"].to_dataset(inherit=False)
    assert np.diff(after["time"].values) == pytest.approx(SEARCH_INTERVAL)
    kept = np.searchsorted(before["time"].values, after["time"].values - 1e-9)
    block = np.array([[before["acceleration"].values[k - 2 + s : k + 3 + s].mean() for s in (-5, 0, 5)] for k in kept])
    expected = block[:, 1] - 0.04 * (block[:, 0] - 2.0 * block[:, 1] + block[:, 2])
    assert after["acceleration"].values.ravel() == pytest.approx(expected)
    left = np.sqrt((1.08**2 + 2 * 0.04**2) / 5.0)
    assert after["acceleration_std"].values == pytest.approx(left * before["acceleration_std"].values)
    assert after["acceleration"].attrs["units"] == "m s-2"


@pytest.mark.parametrize("interval", [1e-4, 5e-5, 1.6e-4])
def test_a_parabola_goes_through_as_it_is(run, quantities, changed, interval):
    def parabola(dataset):
        times = interval * np.arange(dataset.sizes["time"])
        readings = dataset["acceleration"].assign_coords(time=times)
        values = (3.0 - 2e3 * times + 8e5 * times**2).reshape(-1, *[1] * (readings.ndim - 1))
        return dataset.assign_coords(time=times).assign(acceleration=readings * 0.0 + values)

    after = thinned(changed(run, "accelerometer", parabola), quantities)["accelerometer"]
    times = after["time"].values
    assert after["acceleration"].values.ravel() == pytest.approx(3.0 - 2e3 * times + 8e5 * times**2, rel=1e-9)


@pytest.mark.parametrize("interval", [1e-4, 5e-5, 1.25e-4, 2.5e-5])
@pytest.mark.parametrize("start", [-0.0071, 0.0, 0.0023])
def test_what_is_left_is_read_when_film_is_too(run, quantities, changed, interval, start):
    """At whatever instant the recording begins: a simulation tells every instant that something is read."""
    first = round(start / interval)
    moved = changed(
        run,
        "accelerometer",
        lambda dataset: dataset.assign_coords(time=interval * (first + np.arange(dataset.sizes["time"]))),
    )
    times = thinned(moved, quantities)["accelerometer"]["time"].values
    film = run["film"]["time"].values
    inside = film[(film >= times[0] - 1e-9) & (film <= times[-1] + 1e-9)]
    assert inside.size > 20
    assert np.abs(inside[:, None] - times).min(axis=1).max() < 1e-9


def test_the_given_recording_stays_as_it_was(run, quantities):
    before = run.copy(deep=True)
    thinned(run, quantities)
    assert run.identical(before)


def test_film_and_initial_state_are_left_alone(run, quantities):
    after = thinned(run, quantities)
    assert after["film"].identical(run["film"])
    assert after["initial"].identical(run["initial"])


def test_samples_at_uneven_times_are_left_alone(run, quantities, changed):
    uneven = changed(run, "accelerometer", lambda dataset: dataset.isel(time=np.r_[0:500, 503:2000]))
    assert thinned(uneven, quantities)["accelerometer"].sizes["time"] == 1997


@pytest.mark.parametrize("count", [2, 7, 14, 39])
def test_a_few_samples_are_left_alone(run, quantities, changed, count):
    few = changed(run, "accelerometer", lambda dataset: dataset.isel(time=slice(count)))
    assert thinned(few, quantities)["accelerometer"].identical(few["accelerometer"])


@pytest.mark.parametrize("cfc", [0, 600])
@pytest.mark.parametrize(("interval", "kept"), [(3e-4, 3e-4), (2e-4, 6e-4)])
def test_blocks_are_centred_on_a_sample(recorded, model, changed, quantities, cfc, interval, kept):
    """At 5 kHz two samples would do, but they share too much with the next two."""
    run = changed(
        recorded(model, interval=interval), "accelerometer", lambda one: one.assign_attrs(channel_frequency_class=cfc)
    )
    times = thinned(run, quantities)["accelerometer"]["time"].values
    assert np.diff(times) == pytest.approx(kept)
    assert np.isin(times, run["accelerometer"]["time"].values).all()


def test_a_filtered_channel_keeps_the_rate_that_its_filter_needs(run, quantities, changed):
    filtered = changed(run, "accelerometer", lambda dataset: dataset.assign_attrs(channel_frequency_class=180))
    after = thinned(filtered, quantities)["accelerometer"].to_dataset(inherit=False)
    interval = float(np.diff(after["time"].values).max())
    assert 1e-4 < interval <= 1.0 / (10.0 * 180.0)
    kept = filtered["accelerometer"]["acceleration"].sel(time=after["time"], method="nearest")
    assert after["acceleration"].values == pytest.approx(kept.values)


@pytest.mark.parametrize("cfc", [0, 60, 180])
def test_thinning_keeps_the_information(run, quantities, changed, misfit, model, cfc):
    full = changed(run, "accelerometer", lambda dataset: dataset.assign_attrs(channel_frequency_class=cfc))
    curvatures = []
    for recording in (full, thinned(full, quantities)):
        one = misfit(model, run=recording)
        _, jacobian = one.residual_and_jacobian(one.start())
        curvatures.append(jacobian.T @ jacobian)
    before, after = (np.sqrt(np.diag(curvature)) for curvature in curvatures)
    assert after == pytest.approx(before, rel=0.05)


@pytest.mark.parametrize("interval", [1e-4, 5e-5])
def test_thinning_leaves_as_much_noise_as_it_says(recorded, quantities, changed, misfit, model, interval):
    run = recorded(model, interval=interval)
    one = misfit(model, run=thinned(changed(run, "accelerometer", noisy), quantities))
    total = one.channel_sums(one.residual(one.start()))[1]
    count = one.channels[1].samples
    assert total == pytest.approx(count, abs=5.0 * np.sqrt(2.0 * count))


def test_an_open_filter_counts_for_the_noise_alone(run, quantities, changed):
    """What is left of noise that went through CFC 1000, in means about five samples."""
    rng = np.random.default_rng(7)
    times = run["accelerometer"]["time"].values
    spread = filter_channel(rng.normal(0.0, 1.0, (len(times), 40)), times, 1000)
    spread *= float(run["accelerometer"]["acceleration_std"].values.max()) / spread.std()

    def noise(number):
        def replaced(dataset):
            level = dataset["acceleration"] * 0.0 + spread[:, number].reshape(-1, *[1] * (dataset["acceleration"].ndim - 1))
            return dataset.assign(acceleration=level).assign_attrs(channel_frequency_class=1000)

        return changed(run, "accelerometer", replaced)

    thin = [thinned(noise(number), quantities)["accelerometer"].to_dataset(inherit=False) for number in range(40)]
    assert np.diff(thin[0]["time"].values) == pytest.approx(SEARCH_INTERVAL)
    assert thin[0].attrs["channel_frequency_class"] == 0
    left = np.std([one["acceleration"].values for one in thin])
    assert left == pytest.approx(float(thin[0]["acceleration_std"].values.max()), rel=0.05)
