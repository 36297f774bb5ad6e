"""What the charts show is what the diagnosis holds."""

import base64

import numpy as np
import pytest
from attrs import evolve
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crashkit.diagnose.result import Diagnosis
from crashkit.report.channels import ChannelCurves, channels_of
from crashkit.report.charts import ForceRun, block_residual, channel_chart, extremes, force_charts


def values(packed: dict[str, str]) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed["bdata"]), "<f4")


@pytest.fixture
def channel(diagnosis: Diagnosis) -> ChannelCurves:
    return next(one for one in channels_of(diagnosis) if one.sensor == "rear_target")


def test_every_channel_of_every_run_comes_with_its_fits(diagnosis: Diagnosis) -> None:
    channels = list(channels_of(diagnosis))
    assert len(channels) == 16
    assert {one.run for one in channels if one.holdout} == {"holdout_1.nc"}
    table = diagnosis.fits["holdout"]["after"].channels
    one = next(one for one in channels if one.holdout and one.sensor == "sill_right")
    assert one.fits["after"].rating == float(table["rating"].sel(channel="holdout_1.nc/accelerometer/sill_right"))


def test_a_standard_deviation_by_channel_holds_for_all_times(diagnosis: Diagnosis) -> None:
    curves = diagnosis.curves.map_over_datasets(
        lambda group: group.assign(std=group["std"].isel(time=0)) if "std" in group else group
    )
    assert all(
        (one.std == one.std[0]).all() and len(one.std) == len(one.time)
        for one in channels_of(evolve(diagnosis, curves=curves))
    )


def test_curves_are_drawn_in_ms_and_mm_with_their_gaps(channel: ChannelCurves) -> None:
    recorded, before, _, after, _ = channel_chart(channel, with_after=True)["data"]
    assert [trace["name"] for trace in (recorded, before, after)] == ["recorded", "before", "after"]
    np.testing.assert_allclose(values(recorded["x"]), 1e3 * channel.time, rtol=1e-6)
    np.testing.assert_allclose(values(recorded["y"]), 1e3 * channel.recorded, rtol=1e-6)
    assert np.isnan(values(recorded["y"])[60:85]).all()
    np.testing.assert_allclose(values(after["y"]), 1e3 * channel.after, rtol=1e-6)


def test_without_findings_there_is_one_model(channel: ChannelCurves) -> None:
    assert {trace["name"] for trace in channel_chart(channel, with_after=False)["data"]} == {"recorded", "model"}


@pytest.mark.parametrize("correlation", [1, 4])
def test_block_residuals_of_noise_are_standard_normal(channel: ChannelCurves, correlation: int) -> None:
    noise = np.repeat(np.random.default_rng(2).normal(size=24_000), correlation)
    time, zero = 1e-5 * np.arange(len(noise)), np.zeros(len(noise))
    fits = {"after": evolve(channel.fits["after"], independent_samples=24_000.0)}
    noisy = evolve(channel, time=time, recorded=3.0 * noise, std=zero + 3.0, fits=fits)
    _, residual = block_residual(noisy, zero)
    assert len(residual) == 120
    assert residual.std() == pytest.approx(1.0, abs=0.25)


def test_a_channel_without_a_single_value_is_drawn_empty(channel: ChannelCurves) -> None:
    empty = evolve(channel, recorded=np.full_like(channel.recorded, np.nan))
    figure = channel_chart(empty, with_after=True)
    assert np.isnan(values(figure["data"][0]["y"])).all()
    assert figure["layout"]["yaxis2"]["range"] == [-4.0, 4.0]


def test_the_missing_force_is_drawn_in_kn_against_deformation_and_time(diagnosis: Diagnosis) -> None:
    data = diagnosis.missing_force["0/holdout_1.nc"].to_dataset()
    for figure, x in zip(force_charts([ForceRun("a<b", True, data)]), ("deformation", "time"), strict=True):
        band, points, line = figure["data"]
        assert line["name"] == "a&lt;b (never fitted)"
        np.testing.assert_allclose(values(points["x"]), 1e3 * data[x].values, rtol=1e-6)
        np.testing.assert_allclose(values(points["y"]), 1e-3 * data["missing_force"].values, rtol=1e-6)
        np.testing.assert_allclose(values(line["y"]), 1e-3 * data["modelled_force"].values, rtol=1e-6)
        assert len(values(band["x"])) == 2 * data.sizes["time"]


@given(
    samples=arrays(float, st.integers(1, 300), elements=st.one_of(st.floats(-1e6, 1e6), st.just(np.nan))),
    most=st.integers(10, 50),
)
def test_thinning_keeps_the_extremes_in_order(samples: np.ndarray, most: int) -> None:
    kept = extremes(samples, most)
    assert len(kept) <= most
    assert (np.diff(kept) > 0).all()
    if np.isfinite(samples).any():
        assert np.nanmin(samples[kept]) == np.nanmin(samples)
        assert np.nanmax(samples[kept]) == np.nanmax(samples)
