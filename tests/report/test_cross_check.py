"""Figure 6: both displacements, and their difference."""

import numpy as np
import pytest
import xarray as xr

from crashkit.report.cross_check import cross_check_figure


@pytest.fixture
def check() -> xr.Dataset:
    dims, times = ("time", "marker", "axis"), np.linspace(0.0, 0.1, 11)
    path = np.broadcast_to(times[:, None, None], (11, 2, 1))
    variables = {name: (dims, path.copy(), {"units": "m"}) for name in ("film", "accelerometer", "difference")}
    variables |= {f"{name}_std": (dims, 0.1 * path, {"units": "m"}) for name in ("accelerometer", "difference")}
    variables["sentence"] = ("body", ["film and accelerometers of car agree"])
    return xr.Dataset(variables, {"time": times, "marker": ["roof", "sill"], "axis": ["x"], "body": ["car"]})


def test_every_marker_has_both_displacements_and_their_difference(check) -> None:
    figure = cross_check_figure(check)
    names = [trace.name for trace in figure.data if trace.name]
    assert [names.count(name) for name in ("film", "accelerometer", "difference")] == [2, 2, 2]
    film = next(trace for trace in figure.data if trace.name == "film")
    np.testing.assert_array_equal(film.y, check["film"][:, 0, 0])
    assert [note.text for note in figure.layout.annotations][:2] == ["roof x", "roof x: film less accelerometer"]


def test_bands_hold_95_percent(check) -> None:
    band = next(trace for trace in cross_check_figure(check).data if trace.fill == "toself")
    assert max(band.y) == pytest.approx(0.1 + 1.96 * 0.01)


def test_the_verdict_is_the_title(check) -> None:
    assert cross_check_figure(check).layout.title.text == "film and accelerometers of car agree"


def test_hidden_frames_are_left_out_of_the_band(check) -> None:
    check["accelerometer"][3, 0] = np.nan
    band = next(trace for trace in cross_check_figure(check).data if trace.fill == "toself")
    assert np.isfinite(band.y).all()
    assert len(band.y) == 20
