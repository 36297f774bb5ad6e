"""`crashkit check`, and what every command does with files that do not belong together."""

import numpy as np
import pytest

from crashkit.cli import main
from crashkit.data.netcdf import read_tree
from crashkit.data.recording import write_recording
from crashkit.errors import CrashkitError
from crashkit.mechanics import Simulator
from crashkit.model.toml import write_model
from crashkit.registry import load
from crashkit.testing import toys


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A model, a test of it, and tests with a fault each."""
    folder, model = tmp_path_factory.mktemp("given"), toys.one_degree()
    write_model(model, folder / "model.toml", load().spring_laws)
    motion = Simulator(model, load().spring_laws).run(np.linspace(0.0, 0.1, 101), step=5e-4)
    write_recording(toys.recording(motion), folder / "run.nc")
    for name, change in FAULTS.items():
        tree = read_tree(folder / "run.nc")
        change(tree)
        write_recording(tree, folder / f"{name}.nc")
    text = (folder / "model.toml").read_text(encoding="utf-8")
    entry = '\n[[instrument]]\ngroup = "akcelerometer"\n[instrument.parameters]\ngain = 1.0\n'
    (folder / "sensor.toml").write_text(text + entry, encoding="utf-8")
    return folder


def misspelt(tree):
    tree["film"]["marker_body"] = tree["film"]["marker_body"].copy(data=["engin"])


def strange(tree):
    tree["film"].attrs["observer"] = "flim"


def empty(tree):
    del tree["film"], tree["accelerometer"]


FAULTS = {"misspelt": misspelt, "strange": strange, "empty": empty}
TOLD = {
    "misspelt": "misspelt.nc: film/marker_body: expected bodies of the model (",
    "strange": "strange.nc: film: expected an installed observer (",
    "empty": "empty.nc: recording: expected an instrument, a group with the attribute observer, found none",
}


def test_files_that_belong_together(files, capsys, monkeypatch):
    monkeypatch.chdir(files)
    assert main(["check", "model.toml", "run.nc"]) == 0
    assert capsys.readouterr() == ("model.toml: as it should be\nrun.nc: as it should be\n", "")


def test_a_recording_alone_may_have_other_bodies(files, capsys):
    assert main(["check", str(files / "misspelt.nc")]) == 0
    assert capsys.readouterr().out == f"{files}/misspelt.nc: as it should be\n"


def test_a_model_alone_may_have_other_instruments(files, capsys):
    assert main(["check", str(files / "sensor.toml")]) == 0
    assert capsys.readouterr().out == f"{files}/sensor.toml: as it should be\n"


def test_the_faults_of_every_file_are_told(files, capsys, monkeypatch):
    monkeypatch.chdir(files)
    assert main(["check", "empty.nc", "model.toml", "none.nc"]) == 2
    assert capsys.readouterr().err.splitlines() == [
        f"crashkit: {TOLD['empty']}",
        "crashkit: none.nc: expected a netCDF file, found no such file",
    ]


def test_what_a_recording_has_that_the_model_lacks(files, capsys, monkeypatch):
    monkeypatch.chdir(files)
    assert main(["check", "model.toml", "misspelt.nc", "strange.nc"]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first.startswith(f"crashkit: {TOLD['misspelt']}")
    assert second.startswith(f"crashkit: {TOLD['strange']}")


def test_an_instrument_that_no_recording_has(files, capsys, monkeypatch):
    monkeypatch.chdir(files)
    assert main(["check", "sensor.toml", "run.nc"]) == 2
    assert capsys.readouterr().err == (
        'crashkit: sensor.toml: instrument "akcelerometer": expected one of the instruments of the recordings, '
        'found "akcelerometer" (did you mean "accelerometer"?)\n'
    )


@pytest.mark.parametrize("run", FAULTS)
@pytest.mark.parametrize("command", ["diagnose", "identify"])
def test_what_is_checked_is_refused_before_any_work(files, tmp_path, capsys, command, run):
    output = ["--output", str(tmp_path / "new" / "out")] if command == "diagnose" else []
    assert main([command, str(files / "model.toml"), str(files / f"{run}.nc"), *output]) == 2
    out, err = capsys.readouterr()
    assert out == "" and TOLD[run] in err and err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_diagnosis_that_fails_has_told_what_it_did_and_leaves_no_folder(files, tmp_path, capsys, monkeypatch):
    def diagnose(model, recordings, holdout, workshop, progress, seconds):
        progress("fitting clearance at joint first", 0.54)
        raise CrashkitError("no")

    monkeypatch.setattr("crashkit.api.diagnosis.diagnose", diagnose)
    line = ["diagnose", str(files / "model.toml"), str(files / "run.nc"), "--output", str(tmp_path / "new" / "out")]
    assert main(line) == 2
    assert capsys.readouterr() == ("", "fitting clearance at joint first\ncrashkit: no\n")
    assert list(tmp_path.iterdir()) == []


def test_a_simulation_without_end_is_refused(files, tmp_path, capsys):
    line = ["simulate", str(files / "model.toml"), "--duration", "1e9", "--output", str(tmp_path / "motion.nc")]
    assert main(line) == 2
    assert capsys.readouterr().err == "crashkit: duration: expected a positive number of seconds, at most 100, found 1e+09\n"


def test_a_file_in_the_place_of_the_folder(files, tmp_path, capsys):
    (tmp_path / "f").write_text("")
    assert main(["diagnose", str(files / "model.toml"), str(files / "run.nc"), "--output", str(tmp_path / "f")]) == 2
    assert capsys.readouterr().err == f"crashkit: {tmp_path}/f: expected a folder to write to, found a file\n"
