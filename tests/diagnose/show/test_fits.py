"""How well a model predicts, channel by channel: each axis of a sensor is a channel of its own."""

from types import SimpleNamespace

import pytest
import xarray as xr

from crashkit.diagnose.show.fits import curves_of, fit_of
from crashkit.report.channels import channels_of

AXES = {"x": 1.0, "y": 3.0}
"""Standard deviations by which every prediction is off along each axis."""
NAMES = [f"run/{sensor}/{axis}" for sensor in ("film/one", "accelerometer/one") for axis in AXES]


@pytest.fixture
def misfit(watched_in_the_plane):
    channels = tuple(channel for group in watched_in_the_plane for channel in group.channels)
    return SimpleNamespace(groups=watched_in_the_plane, channels=channels)


@pytest.fixture
def predictions(misfit):
    stds = [[channel.noise.std for channel in group.channels] for group in misfit.groups]
    return [
        SimpleNamespace(samples=group.recorded + [std * off for std, off in zip(own, AXES.values(), strict=True)])
        for group, own in zip(misfit.groups, stds, strict=True)
    ]


def test_each_axis_of_a_sensor_has_its_own_figure(misfit, predictions):
    table = fit_of(misfit, predictions).channels
    assert table["channel"].values.tolist() == NAMES
    assert table["normalised_rmse"].values == pytest.approx([1.0, 3.0, 1.0, 3.0])


def test_and_its_own_curve_with_that_figure(misfit, predictions):
    fit = fit_of(misfit, predictions)
    curves = curves_of(misfit, misfit, (predictions, predictions), holdout=False)
    tree = xr.DataTree.from_dict(dict(curves))
    told = SimpleNamespace(curves=tree, fits={"calibration": {"before": fit, "after": fit}})
    found = {f"{c.run}/{c.instrument}/{c.sensor}": c.fits["after"].normalised_rmse for c in channels_of(told)}
    assert found == pytest.approx(dict(zip(NAMES, [1.0, 3.0, 1.0, 3.0], strict=True)))
