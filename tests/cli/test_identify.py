"""The command `identify`: what it prints and writes, and how a method that cannot work ends."""

import json
import re
import shutil

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.api import load_model
from crashkit.cli import main
from crashkit.data.netcdf import read_tree
from crashkit.data.recording import write_recording
from crashkit.mechanics import Simulator
from crashkit.model.toml import write_model
from crashkit.protocols import Identification, Status
from crashkit.registry import load
from crashkit.report.held import Held, told
from crashkit.report.identification import as_plain, as_text
from crashkit.testing import toys


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A toy 10 % off, and a test of the true one with noise."""
    folder, truth = tmp_path_factory.mktemp("given"), toys.one_degree()
    write_model(toys.start_from(truth, 0.9), folder / "model.toml", load().spring_laws)
    motion = Simulator(truth, load().spring_laws).run(np.linspace(0.0, 0.3, 301), step=5e-4)
    write_recording(toys.noisy(toys.recording(motion), 0.01, np.random.default_rng(0)), folder / "run.nc")
    return folder


def command(folder, *more):
    return ["identify", str(folder / "model.toml"), str(folder / "run.nc"), *map(str, more)]


def test_it_prints_a_table_and_needs_no_output(folder, capsys):
    assert main(command(folder)) == 0
    told = capsys.readouterr()
    assert told.out.startswith("converged: no step lowers the misfit any further\nthe residuals are ")
    row = re.search(r"joint\.first\.crush_force +(\S+) +N +(\S+) +(\S+) to (\S+)\n", told.out)
    value, std, low, high = map(float, row.groups())
    assert low < value < high and value == pytest.approx(24000.0, abs=4.0 * std)
    assert re.match(r"step 1: cost \S+\n", told.err)


def test_progress_is_told_every_so_often(folder, capsys, monkeypatch):
    monkeypatch.setattr("crashkit.api.files.PROGRESS_INTERVAL", np.inf)
    assert main(command(folder, "--method", "sensitivity")) == 0
    assert re.fullmatch(r"step 1: cost \S+\n", capsys.readouterr().err)


def test_the_json_holds_what_the_result_says(folder, tmp_path):
    file, model = tmp_path / "result.json", tmp_path / "found.toml"
    assert main(command(folder, "--method", "sensitivity", "--json", file, "--output", model)) == 0
    document = json.loads(file.read_text(encoding="utf-8"))
    assert document["schema"] == "crashkit-identification/1"
    assert (document["method"], document["runs"], document["status"]) == ("sensitivity", ["run.nc"], "CONVERGED")
    values = {row["parameter"]: row["value"] for row in document["parameters"]}
    found = load_model(model).free_parameters()
    assert values == pytest.approx({path: parameter.value for path, parameter in found.items()})
    assert np.diag(document["covariance"]) == pytest.approx([row["std"] ** 2 for row in document["parameters"]], rel=0.3)
    assert document["path"]["value"][-1] == pytest.approx(list(values.values()))


def test_a_method_that_is_not_there(folder, capsys):
    assert main(command(folder, "--method", "magic")) == 2
    assert 'no identifier "magic" is installed, expected one of chebyshev, ' in capsys.readouterr().err


def test_a_method_that_cannot_take_the_recordings_says_why(folder, tmp_path, capsys):
    """Nothing saw the front: it has no measured motion."""
    tree = read_tree(folder / "run.nc")
    for name, variable in (("film", "marker_body"), ("accelerometer", "sensor_body")):
        group = tree[name].to_dataset(inherit=False)
        tree[name] = xr.DataTree(group.assign({variable: group[variable].copy(data=["wall"])}))
    write_recording(tree, tmp_path / "blind.nc")
    line = ["identify", str(folder / "model.toml"), str(tmp_path / "blind.nc"), "--method", "state_form"]
    assert main(line) == 2
    assert (
        "state_form needs the measured motion of every body that a joint holds, found none of front" in capsys.readouterr().err
    )


def test_a_model_with_nothing_free(folder, tmp_path, capsys):
    model = load_model(folder / "model.toml")
    fixed = model.with_parameters({path: evolve(p, fixed=True) for path, p in model.free_parameters().items()})
    write_model(fixed, tmp_path / "fixed.toml", load().spring_laws)
    assert main(["identify", str(tmp_path / "fixed.toml"), str(folder / "run.nc")]) == 2
    assert "expected a free parameter, found that all are fixed" in capsys.readouterr().err


def result(**changes):
    """One parameter as a method may find it."""
    row = {"value": 2.0, "std": 0.1, "interval_lower": 1.8, "interval_upper": 2.2, "lower": 0.5, "upper": np.inf}
    row |= {"at_bound": False, "identifiable": True, "units": "m"} | changes
    table = xr.Dataset({name: ("parameter", [value]) for name, value in row.items()}, {"parameter": ["gap"]})
    table["covariance"] = (("parameter", "parameter_2"), [[row["std"] ** 2]])
    table.attrs = {"normalised_residual": 1.02, "remarks": "A remark."}
    return Identification(table, Status.STALLED, 7.0, ("gap is a riddle",))


ROWS = {
    "known": ({}, "gap        2      m     0.1  1.8 to 2.2"),
    "from below only": (
        {"interval_upper": np.inf, "std": np.inf, "identifiable": False},
        "gap        2      m     -    at least 1.8   not identifiable",
    ),
    "from above only": (
        {"interval_lower": 0.5, "std": np.inf, "identifiable": False},
        "gap        2      m     -    at most 2.2    not identifiable",
    ),
    "not at all": (
        {"interval_lower": 0.5, "interval_upper": np.inf, "std": np.nan, "identifiable": False, "units": ""},
        "gap        2      -     -    -              not identifiable",
    ),
    "held": (
        {
            "value": 0.5,
            "interval_lower": 0.5,
            "interval_upper": np.inf,
            "std": np.nan,
            "at_bound": True,
            "identifiable": False,
        },
        "gap        0.5    m     -    -              at its lower bound",
    ),
}


@pytest.mark.parametrize("kind", ROWS)
def test_a_parameter_is_told_as_far_as_it_is_known(kind):
    changes, row = ROWS[kind]
    text = as_text(result(**changes))
    assert row in [line.rstrip() for line in text.splitlines()]


def test_status_sentences_and_remarks_are_told():
    text = as_text(result())
    assert text.startswith("not converged: no acceptable step was found, and the gradient is not zero\n")
    assert "the residuals are 1.02 times the noise" in text
    assert text.endswith("not known from these recordings:\n  gap is a riddle\n\nA remark.")


def test_a_number_and_its_interval_are_in_one_format():
    known = {"value": 230736.0, "std": 1230.0, "interval_lower": 228419.0, "interval_upper": 233084.0}
    assert "gap        230736  m     1200  228420 to 233080" in as_text(result(**known))


def test_readings_that_were_left_out_are_told_first_where_they_are_many():
    found = result()
    found.parameters.attrs |= {"left_out": {"run/film/dot": 0.36, "run/film/spot": 0.02}, "normalised_residual_of_all": 8.4}
    lines = as_text(found).splitlines()
    told = "36 % of run/film/dot does not fit and was left out; with all readings the residuals are 8.4 times the noise"
    assert lines[1:3] == ["the residuals are 1.02 times the noise", told]
    document = as_plain(found)
    assert document["normalised_residual_of_all"] == 8.4
    assert document["left_out"] == {"run/film/dot": 0.36, "run/film/spot": 0.02}


def test_where_nothing_was_left_out_all_readings_are_those_that_fit():
    document = as_plain(result())
    assert (document["normalised_residual_of_all"], document["left_out"]) == (1.02, {})


def test_what_was_held_is_told_with_the_value_and_why(folder, tmp_path, capsys):
    """A start at the law's null leaves the physics out."""
    file = tmp_path / "result.json"
    assert main(command(folder, "--method", "sensitivity", "--json", file)) == 0
    told = capsys.readouterr().out.split("held:\n")[1].split("\n\n")[0]
    assert re.search(r"  joint\.first: .*rate_coefficient.* at 0.* \(the law's null\)", told)
    assert "  body.front: mass at 1000" in told
    held = json.loads(file.read_text(encoding="utf-8"))["held"]
    assert {"parameter": "body.front.mass", "value": 1000.0, "why": "fixed"} in held
    assert {"parameter": "joint.first.rate_coefficient", "value": 0.0, "why": "null"} in held


def test_joints_of_which_the_same_was_held_share_a_line():
    held = [Held(f"joint.{name}.{number}", value, why) for name in "ab" for number, value, why in HELD]
    assert told(held) == "held:\n  joint.a, joint.b: gap, slope at 0 (the law's null); curve at 2, table at 2 numbers"


HELD = (
    ("gap", 0.0, "null"),
    ("curve[0]", 2.0, "fixed"),
    ("curve[1]", 2.0, "fixed"),
    ("table[0]", 1.0, "fixed"),
    ("table[1]", 3.0, "fixed"),
    ("slope", 0.0, "null"),
)


def test_what_is_not_finite_is_null_in_json():
    document = as_plain(result(std=np.inf, interval_upper=np.nan))
    assert json.loads(json.dumps(document, allow_nan=False))["parameters"][0] == {
        "parameter": "gap",
        "value": 2.0,
        "std": None,
        "interval_lower": 1.8,
        "interval_upper": None,
        "lower": 0.5,
        "upper": None,
        "at_bound": False,
        "identifiable": True,
        "units": "m",
    }


def test_it_predicts_a_test_that_is_not_fitted_and_writes_the_bands(folder, tmp_path, capsys):
    """A faster test: most of its readings lie in the band and its noise."""
    motion = Simulator(toys.one_degree(), load().spring_laws).run(
        np.linspace(0.0, 0.3, 301), initial=toys.initial_state(toys.one_degree(), 1.2), step=5e-4
    )
    write_recording(toys.noisy(toys.recording(motion), 0.01, np.random.default_rng(1)), tmp_path / "faster.nc")
    file = tmp_path / "curves.nc"
    assert main(command(folder, "--predict", tmp_path / "faster.nc", "--curves", file)) == 0
    told = capsys.readouterr().out
    assert re.search(r"predicted, not fitted:\n  faster\.nc/film: residuals \S+ times the noise, the parameters leave", told)
    assert re.search(
        r"\n  faster\.nc/accelerometer: residuals \S+ times the noise, the parameters leave ±\S+ m s-2 open", told
    )
    curves = read_tree(file)
    assert curves["run.nc/film"].attrs["fitted"] == 1 and curves["faster.nc/film"].attrs["fitted"] == 0
    film = curves["faster.nc/film"]
    reach = 1.96 * film["noise"]
    inside = (film["recorded"] > film["lower"] - reach) & (film["recorded"] < film["upper"] + reach)
    assert 0.9 < float(inside.mean()) < 1.0


def test_a_run_that_is_fitted_is_no_prediction(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    assert main(["identify", "model.toml", "run.nc", "--predict", "./run.nc"]) == 2
    assert capsys.readouterr().err == "crashkit: run.nc: expected each run once, fitted or held out, found it twice\n"


def test_a_copy_of_a_run_that_is_fitted_is_no_prediction(folder, tmp_path, capsys):
    shutil.copy(folder / "run.nc", tmp_path / "copy.nc")
    assert main(command(folder, "--predict", tmp_path / "copy.nc")) == 2
    assert capsys.readouterr().err == (
        "crashkit: copy.nc: expected each run once, fitted or held out, found the values of run.nc\n"
    )
