"""The functions behind the command line, on files: what they write, and how bad input ends."""

import json
import re
import subprocess
import sys
from inspect import isfunction
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

import crashkit
from crashkit import api
from crashkit.cli import main
from crashkit.data.recording import read_recording, write_recording
from crashkit.diagnose import Workshop
from crashkit.errors import CrashkitError
from crashkit.mechanics import Simulator
from crashkit.model.toml import write_model
from crashkit.registry import load
from crashkit.testing import toys


@pytest.fixture(scope="module")
def equipped() -> Workshop:
    return api.workshop().rehearsed(toys.two_degrees(), [])


@pytest.fixture(scope="module")
def given(tmp_path_factory, equipped) -> Path:
    """model.toml and run.nc, a perfect test of it."""
    folder, model = tmp_path_factory.mktemp("given"), toys.one_degree()
    write_model(model, folder / "model.toml", load().spring_laws)
    motion = Simulator(model, load().spring_laws, equipped.engine).run(np.linspace(0.0, 0.2, 201), step=5e-4)
    recording, random = toys.recording(motion), np.random.default_rng(0)
    for name, quantity, std in (("film", "position", 1e-3), ("accelerometer", "acceleration", 1.0)):
        recording[name][quantity] += random.normal(0.0, std, recording[name][quantity].shape)
    write_recording(recording, folder / "run.nc")
    return folder


@pytest.fixture
def quick(equipped, monkeypatch):
    """A diagnosis that knows one hypothesis, with the engine that is there already."""
    few = evolve(equipped, hypotheses={"clearance": equipped.hypotheses["clearance"]})
    monkeypatch.setattr("crashkit.api.diagnosis.workshop", lambda: few)


def test_a_diagnosis_writes_its_files(quick, given, tmp_path):
    told = []
    result = api.diagnose_files(given / "model.toml", [given / "run.nc"], [], tmp_path / "new" / "out", told.append)
    output = tmp_path / "new" / "out"
    assert {path.name for path in output.iterdir()} >= {"diagnosis.json", "curves.nc", "augmented_model.toml", "index.html"}
    document = json.loads((output / "diagnosis.json").read_text(encoding="utf-8"))
    assert (document["verdict"], result.verdict) == ("consistent", "consistent")
    assert api.load_model(output / "augmented_model.toml") == result.augmented_model
    assert told[0] == "re-identifying the model"


def test_a_diagnosis_that_fails_leaves_the_old_answer(quick, given, tmp_path, monkeypatch):
    (tmp_path / "diagnosis.json").write_text("old")

    def fail(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("crashkit.report.document.write_text", fail)
    assert main(["diagnose", str(given / "model.toml"), str(given / "run.nc"), "--output", str(tmp_path)]) == 2
    assert (tmp_path / "diagnosis.json").read_text() == "old"


def test_a_simulation_is_written_with_its_time(given, tmp_path):
    assert main(["simulate", str(given / "model.toml"), "--duration", "0.01", "--output", str(tmp_path / "motion.nc")]) == 0
    motion = xr.load_dataset(tmp_path / "motion.nc")
    assert motion["time"].values[-1] == pytest.approx(0.01)
    assert float(motion["velocity"].sel(body="front").isel(time=0, axis=0)) == toys.SPEED


def test_an_identified_model_is_written(given, tmp_path, capsys):
    line = ["identify", str(given / "model.toml"), str(given / "run.nc"), "--output", str(tmp_path / "found.toml")]
    assert main(line) == 0
    out = capsys.readouterr().out
    assert out.startswith("converged")
    assert re.search(r"joint.first.crush_force +2(40|39)", out)
    found = api.load_model(tmp_path / "found.toml").parameters()["joint.first.crush_force"].value
    assert found == pytest.approx(24000.0, rel=0.01)


def test_files_that_are_as_they_should_be(given, capsys):
    assert main(["check", str(given / "model.toml"), str(given / "run.nc")]) == 0
    assert [line.split(": ")[1] for line in capsys.readouterr().out.splitlines()] == ["as it should be"] * 2


def rewritten(change):
    """The recording with a change that `write_recording` need not like."""

    def make(folder, given):
        tree = read_recording(given / "run.nc", {name: kind.schema for name, kind in load().observers.items()})
        tree = change(tree)
        tree.to_netcdf(folder / "run.nc", engine="netcdf4")

    return make


def truncated(folder, given):
    (folder / "run.nc").write_bytes((given / "run.nc").read_bytes()[:3000])


def film(change):
    return rewritten(lambda tree: tree.assign(film=xr.DataTree(change(tree["film"].to_dataset(inherit=False)))))


def in_millimetres(dataset):
    dataset["position"].attrs["units"] = "mm"
    return dataset


def hidden(dataset):
    dataset["position"][:] = np.nan
    return dataset


def backwards(dataset):
    times = dataset["time"].values.copy()
    times[5] = times[3]
    return dataset.assign_coords(time=("time", times, {"units": "s"}))


def model_text(old, new):
    def make(folder, given):
        text = (given / "model.toml").read_text(encoding="utf-8")
        assert old in text
        (folder / "model.toml").write_text(text.replace(old, new), encoding="utf-8")

    return make


BAD = {
    "no such file": (lambda folder, given: (folder / "run.nc").unlink(), "expected a netCDF file, found no such file"),
    "a truncated file": (truncated, "expected a netCDF file, found one that cannot be read"),
    "a wrong unit": (film(in_millimetres), "film/position: expected "),
    "dims out of order": (
        film(lambda d: d.assign(position=d["position"].transpose("axis", "marker", "time"))),
        "film/position: expected ",
    ),
    "time that goes back": (film(backwards), "film/time: expected "),
    "a channel without any reading": (film(hidden), "film/position: expected "),
    "an unknown body": (film(lambda d: d.assign(marker_body=("marker", ["engine"]))), "film/marker_body: expected bodies of "),
    "a value out of bounds": (model_text("value = 24000.0", "value = 1.0"), "crush_force: expected "),
    "a law that is not installed": (model_text('law = "crush_plateau"', 'law = "origami"'), "law: expected "),
    "broken TOML": (model_text("[[joint]]", "[[joint"), "model.toml: "),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_told_in_one_line_and_nothing_is_written(quick, given, tmp_path, capsys, case):
    spoil, message = BAD[case]
    for name in ("model.toml", "run.nc"):
        (tmp_path / name).write_bytes((given / name).read_bytes())
    spoil(tmp_path, given)
    output = tmp_path / "out"
    status = main(["diagnose", str(tmp_path / "model.toml"), str(tmp_path / "run.nc"), "--output", str(output)])
    out, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if line.startswith("crashkit: ")]
    assert status == 2
    assert out == ""
    assert len(lines) == 1 and message in lines[0] and "Traceback" not in err
    assert not output.exists() or not any(output.iterdir())


def test_a_run_cannot_be_fitted_and_held_out(given, tmp_path, capsys):
    run = str(given / "run.nc")
    assert main(["diagnose", str(given / "model.toml"), run, "--holdout", run, "--output", str(tmp_path / "out")]) == 2
    assert "run.nc: expected each run once, fitted or held out, found it twice" in capsys.readouterr().err


@pytest.mark.parametrize("duration", ["0", "-1", "nan", "inf"])
def test_a_duration_that_is_none_is_refused(given, tmp_path, capsys, duration):
    line = ["simulate", str(given / "model.toml"), "--duration", duration, "--output", str(tmp_path / "motion.nc")]
    assert main(line) == 2
    assert "duration: expected a positive number of seconds" in capsys.readouterr().err
    assert not (tmp_path / "motion.nc").exists()


def test_files_are_named_by_text_or_by_a_path_and_one_stands_for_a_list(given):
    model, run = given / "model.toml", given / "run.nc"
    assert api.load_model(str(model)) == api.load_model(model)
    for one in (str(run), run, [str(run)], iter([run])):
        assert list(api.load_recordings(one)) == ["run.nc"]
    assert api.check_files(str(model)) == f"{model}: as it should be"
    assert api.check_files([str(model), run]) == f"{model}: as it should be\n{run}: as it should be"


@pytest.mark.parametrize("ask", [api.load_model, api.load_recordings, api.check_files])
def test_what_is_no_path(ask):
    wrong = 3 if ask is api.load_model else [3]
    with pytest.raises(CrashkitError, match="^expected a path, found 3$"):
        ask(wrong)


@pytest.mark.parametrize("ask", [api.identify_files, api.diagnose_files])
def test_no_recording_to_fit(given, ask):
    with pytest.raises(CrashkitError, match="^runs: expected at least one recording to fit, found none$"):
        ask(given / "model.toml", [])


@pytest.mark.parametrize("seconds", [-1, 0, float("nan")])
def test_a_time_limit_that_is_none(given, seconds):
    with pytest.raises(CrashkitError, match=f"^seconds: expected a number above 0, found {seconds}$"):
        api.diagnose_files(given / "model.toml", given / "run.nc", seconds=seconds)


def test_what_need_not_be_said(quick, given, tmp_path, monkeypatch):
    """Nothing is held out, nobody follows, nothing is written."""
    monkeypatch.chdir(tmp_path)
    result = api.diagnose_files(str(given / "model.toml"), str(given / "run.nc"))
    assert result.verdict == "consistent"
    assert repr(result) == f"diagnosis: consistent\n{result.summary}"
    assert not list(tmp_path.iterdir())


def test_an_identification_is_an_object_that_prints_as_the_command_does(given):
    found = api.identify_files(str(given / "model.toml"), str(given / "run.nc"), output=None)
    assert str(found) == repr(found)
    assert str(found).startswith("converged")
    path = "joint.first.crush_force"
    assert found.model.parameters()[path].value == found.result.values[path] == pytest.approx(24000.0, rel=0.01)
    assert found.curves is None


def test_completion_offers_the_public_functions():
    assert dir(api) == sorted(api.__all__)
    assert all(callable(getattr(api, name)) for name in api.__all__)
    functions = {name for name, one in vars(api).items() if isfunction(one) and one.__module__.startswith("crashkit.api")}
    assert {name for name in functions if not name.startswith("_")} <= set(api.__all__)


def test_the_package_offers_its_rooms_and_loads_none():
    assert dir(crashkit) == sorted(crashkit.__all__)
    assert all(getattr(crashkit, name).__name__ == f"crashkit.{name}" for name in crashkit.__all__)
    with pytest.raises(AttributeError, match=r"^module 'crashkit' has no attribute 'colour'$"):
        crashkit.colour  # noqa: B018
    code = "import sys, crashkit; assert not [m for m in sys.modules if m.startswith(('crashkit.', 'numpy', 'xarray'))]"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_runs_of_one_name_keep_their_folders(given, tmp_path):
    (tmp_path / "run.nc").write_bytes((given / "run.nc").read_bytes())
    names = list(api.load_recordings([given / "run.nc", tmp_path / "run.nc"]))
    assert names == [str(given / "run.nc"), str(tmp_path / "run.nc")]


def test_recordings_in_memory_are_diagnosed_as_their_files_are(quick, given):
    model, recordings = api.load_model(given / "model.toml"), api.load_recordings(given / "run.nc")
    from_files = api.diagnose_files(given / "model.toml", given / "run.nc")
    assert api.diagnose_recordings(model, recordings).summary == from_files.summary


def test_recordings_in_memory_keep_the_contract(quick, given):
    model, recordings = api.load_model(given / "model.toml"), api.load_recordings(given / "run.nc")
    film = recordings["run.nc"]["film"].to_dataset(inherit=False)
    broken = recordings["run.nc"].assign(film=xr.DataTree(film.drop_vars("marker_body")))
    with pytest.raises(
        CrashkitError, match=r"^of mine: film/marker_body: expected a variable with dims \(marker\), found none$"
    ):
        api.diagnose_recordings(model, {"of mine": broken})
    with pytest.raises(CrashkitError, match=r"^run\.nc: expected each run once, fitted or held out, found it twice$"):
        api.diagnose_recordings(model, recordings, recordings)
    with pytest.raises(CrashkitError, match=r"^seconds: expected a number above 0, found 0\.0$"):
        api.diagnose_recordings(model, recordings, seconds=0.0)


def test_a_sensor_that_recorded_nothing_is_left_out_with_a_warning(quick, given, tmp_path):
    model, recordings = api.load_model(given / "model.toml"), api.load_recordings(given / "run.nc")
    film = recordings["run.nc"]["film"].to_dataset(inherit=False)
    hidden = film.assign_coords(marker=["hidden"]).assign(position=film["position"] * np.nan)
    both = recordings["run.nc"].assign(film=xr.DataTree(xr.concat([film, hidden], "marker", data_vars="minimal")))
    write_recording(both, tmp_path / "run.nc")
    sentence = 'run.nc: film/position: only NaN of "hidden"; left out'
    told = f"^{re.escape(sentence)}$"
    with pytest.warns(UserWarning, match=told):
        from_files = api.diagnose_files(given / "model.toml", tmp_path / "run.nc")
    with pytest.warns(UserWarning, match=told):
        from_memory = api.diagnose_recordings(model, {"run.nc": both})
    assert from_files.summary == from_memory.summary == api.diagnose_recordings(model, recordings).summary
    assert from_files.notes.count(sentence) == from_memory.notes.count(sentence) == 1
