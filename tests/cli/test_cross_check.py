"""`crashkit cross-check`: film against accelerometers of a file, with a verdict and a page."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from crashkit.cli import main
from crashkit.data.netcdf import read_tree
from crashkit.data.recording import write_recording

METRES, SPEEDS, ACCELERATIONS = {"units": "m"}, {"units": "m s-1"}, {"units": "m s-2"}
TIMES, FRAMES = np.arange(1001) * 1e-4, np.arange(100) * 1e-3


def stop(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A stop from 15 m/s within 90 ms: position and acceleration."""
    w, s = 2.0 * np.pi / 0.09, np.minimum(times, 0.09)
    return 15.0 * s - 15.0 / 0.09 * (0.5 * s**2 + (np.cos(w * s) - 1.0) / w**2), -15.0 / 0.09 * (1.0 - np.cos(w * s))


def written(path: Path, gain: float = 1.0) -> Path:
    """A recording of it, with an accelerometer of that sensitivity, and names that a page must not take for tags."""
    random = np.random.default_rng(0)
    seen = stop(FRAMES)[0] + 1e-3 * random.normal(size=len(FRAMES))
    felt = gain * stop(TIMES)[1] + 3.0 * random.normal(size=len(TIMES))
    film = xr.Dataset(
        {
            "position": (("time", "marker", "axis"), seen[:, None, None], METRES),
            "marker_body": ("marker", ["<car>"]),
            "marker_point": (("marker", "axis"), [[0.0]], METRES),
            "position_std": ("marker", [1e-3], METRES),
        },
        {"time": ("time", FRAMES, {"units": "s"}), "marker": ["door"], "axis": ["x"]},
        {"observer": "film"},
    )
    accelerometer = xr.Dataset(
        {
            "acceleration": (("time", "sensor", "axis"), felt[:, None, None], ACCELERATIONS),
            "sensor_body": ("sensor", ["<car>"]),
            "sensor_point": (("sensor", "axis"), [[0.0]], METRES),
            "acceleration_std": ("sensor", [3.0], ACCELERATIONS),
        },
        {"time": ("time", TIMES, {"units": "s"}), "sensor": ["tunnel"], "axis": ["x"]},
        {"observer": "accelerometer", "channel_frequency_class": 0, "frame": "laboratory"},
    )
    initial = xr.Dataset(
        {"position": (("body", "axis"), [[0.0]], METRES), "velocity": (("body", "axis"), [[15.0]], SPEEDS)},
        {"body": ["<car>"], "axis": ["x"]},
    )
    groups = {"film": film, "accelerometer": accelerometer, "initial": initial}
    tree = xr.DataTree.from_dict(groups)
    tree.attrs.update(crashkit_schema="recording/1", title="stop")
    write_recording(tree, path)
    return path


@pytest.mark.parametrize(
    ("gain", "verdict", "headline"),
    [(1.0, "agree", "The instruments agree"), (1.05, "contradict each other", "The instruments contradict each other")],
)
def test_a_verdict_is_printed_and_a_page_written(tmp_path, capsys, gain, verdict, headline) -> None:
    recording = written(tmp_path / "run.nc", gain)
    assert main(["cross-check", str(recording), "--known-velocity", "--output", str(tmp_path / "answer")]) == 0
    told = capsys.readouterr().out
    assert told.startswith(f"film and accelerometers of <car> {verdict} (chi-square ")
    assert told.endswith(f"wrote {tmp_path}/answer/index.html\nwrote {tmp_path}/answer/cross_check.nc\n")
    assert "not compared" not in told
    assert {path.name for path in (tmp_path / "answer").iterdir()} == {"index.html", "plotly.min.js", "cross_check.nc"}
    page = (tmp_path / "answer" / "index.html").read_text(encoding="utf-8")
    assert f"<h1>{headline}</h1>" in page
    assert "<td>&lt;car&gt;</td>" in page
    assert "door x: film less accelerometer" in page
    with xr.open_dataset(tmp_path / "answer" / "cross_check.nc") as check:
        assert bool(check["consistent"][0]) == (gain == 1.0)
        assert check["difference"].dims == ("time", "marker", "axis")


def test_a_group_that_is_not_there_is_told_with_its_file(tmp_path, capsys) -> None:
    recording = written(tmp_path / "run.nc")
    assert main(["cross-check", str(recording), "--film", "camera", "--output", str(tmp_path / "answer")]) == 2
    expected = f"crashkit: {recording}: expected a group camera, found film, accelerometer, initial\n"
    assert capsys.readouterr().err == expected
    assert not (tmp_path / "answer").exists()


def test_a_body_that_one_of_them_alone_watches_is_told(tmp_path, capsys) -> None:
    tree = read_tree(written(tmp_path / "run.nc"))
    film = tree["film"].to_dataset()
    tree["film"] = xr.concat([film, film.assign_coords(marker=["hatch"]).assign(marker_body=("marker", ["batery"]))], "marker")
    write_recording(tree, tmp_path / "run.nc")
    assert main(["cross-check", str(tmp_path / "run.nc"), "--output", str(tmp_path / "answer")]) == 0
    assert "\nnot compared: batery of film\nwrote " in capsys.readouterr().out


def test_a_model_is_no_recording(tmp_path, capsys) -> None:
    (tmp_path / "model.toml").write_text("")
    assert main(["cross-check", str(tmp_path / "model.toml"), "--output", str(tmp_path / "answer")]) == 2
    assert capsys.readouterr().err == f"crashkit: {tmp_path}/model.toml: expected a netCDF file, found a model (TOML)\n"


def test_a_report_is_never_written_over_the_recording(tmp_path, capsys) -> None:
    recording = written(tmp_path / "cross_check.nc")
    before = recording.read_bytes()
    assert main(["cross-check", str(recording), "--output", str(tmp_path)]) == 2
    expected = f"crashkit: {recording}: expected a file of its own for the output, found one of the inputs\n"
    assert capsys.readouterr().err == expected
    assert recording.read_bytes() == before
