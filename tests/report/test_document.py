"""diagnosis.json keeps to its schema, whatever the diagnosis holds."""

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from attrs import evolve

from crashkit.data.netcdf import read_tree
from crashkit.diagnose.result import Diagnosis, Estimate, Fit
from crashkit.report import diagnosis_json, write_curves, write_json
from crashkit.report.document import plain


def strict(text: str) -> dict:
    """JSON as its standard has it: NaN and Infinity are refused."""

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is not JSON")

    return json.loads(text, parse_constant=refuse)


def test_it_has_the_keys_of_the_schema(diagnosis: Diagnosis) -> None:
    document = diagnosis_json(diagnosis)
    assert document["schema"] == "crashkit-diagnosis/1"
    assert document["verdict"] == "missing_physics"
    assert document["augmented_model"] == "augmented_model.toml"
    finding = document["findings"][0]
    assert finding["physics"] == "rate_dependence"
    assert finding["probability"] == 0.972
    assert finding["location"] == {"joint": "front"}
    assert finding["runs"] == ["run_1.nc", "run_2.nc", "run_3.nc", "holdout_1.nc"]
    assert finding["time"] == [0.0012, 0.094]
    assert finding["phase"] == "loading"
    assert finding["parameters"]["rate_coefficient"] == {
        "value": 0.0221,
        "std": 0.0006,
        "units": "s m-1",
        "identifiable": True,
    }
    assert finding["alternatives"][0]["physics"] == "viscous_damping"
    assert finding["alternatives"][0]["probability"] == 0.021


@pytest.mark.parametrize("runs", ["calibration", "holdout"])
@pytest.mark.parametrize("model", ["before", "after"])
def test_each_fit_is_given_overall_and_by_channel(diagnosis: Diagnosis, runs: str, model: str) -> None:
    entry = diagnosis_json(diagnosis)["fit"][runs][model]
    fit = diagnosis.fits[runs][model]
    assert entry["normalised_rmse"] == fit.normalised_rmse
    assert list(entry["channels"]) == list(fit.channels["channel"].values)
    for channel, measures in entry["channels"].items():
        assert measures["normalised_rmse"] == float(fit.channels["normalised_rmse"].sel(channel=channel))
        assert measures["rating"] == float(fit.channels["rating"].sel(channel=channel))


def test_what_is_left_of_all_runs_is_given_where_it_was_asked_for(diagnosis: Diagnosis) -> None:
    held = diagnosis.fits["holdout"]
    asked = evolve(diagnosis, fits={**diagnosis.fits, "holdout": {**held, "after": evolve(held["after"], together_rmse=1.01)}})
    assert diagnosis_json(asked)["fit"]["holdout"]["after"]["together_rmse"] == 1.01
    assert "together_rmse" not in diagnosis_json(diagnosis)["fit"]["holdout"]["after"]


def test_the_file_is_what_the_dictionary_says(diagnosis: Diagnosis, tmp_path: Path) -> None:
    path = write_json(diagnosis, tmp_path / "new folder" / "diagnosis.json")
    assert strict(path.read_text("utf-8")) == diagnosis_json(diagnosis)


def test_what_is_not_finite_becomes_null(diagnosis: Diagnosis, tmp_path: Path) -> None:
    finding = evolve(
        diagnosis.findings[0],
        probability=np.float64("nan"),
        parameters={"rate_coefficient": Estimate(0.02, float("inf"), "s m-1")},
    )
    table = xr.Dataset({"normalised_rmse": ("channel", [1.0]), "rating": ("channel", [np.nan])}, {"channel": ["a/b/c"]})
    changed = evolve(diagnosis, findings=(finding,), fits={"calibration": {"before": Fit(float("nan"), table)}})
    document = strict(write_json(changed, tmp_path / "diagnosis.json").read_text("utf-8"))
    assert document["findings"][0]["probability"] is None
    assert document["findings"][0]["parameters"]["rate_coefficient"]["std"] is None
    assert document["fit"]["calibration"]["before"]["normalised_rmse"] is None
    assert document["fit"]["calibration"]["before"]["channels"]["a/b/c"] == {"normalised_rmse": 1.0, "rating": None}


def test_without_holdout_or_findings_the_keys_stay(diagnosis: Diagnosis) -> None:
    document = diagnosis_json(evolve(diagnosis, findings=(), fits={"calibration": diagnosis.fits["calibration"]}))
    assert document["findings"] == []
    assert document["fit"]["holdout"] == {"before": {}, "after": {}}


def test_numpy_values_and_tuples_are_written_as_plain_json(diagnosis: Diagnosis, tmp_path: Path) -> None:
    finding = evolve(
        diagnosis.findings[0], location={"bodies": ("wall", np.str_("vehicle"))}, time=(np.float32(0.5), np.int64(1))
    )
    document = strict(write_json(evolve(diagnosis, findings=(finding,)), tmp_path / "diagnosis.json").read_text("utf-8"))
    assert document["findings"][0]["location"] == {"bodies": ["wall", "vehicle"]}
    assert document["findings"][0]["time"] == [0.5, 1]


@pytest.mark.parametrize("table", ["ranking", "identified", "consistency", "detectable"])
def test_the_tables_of_the_page_are_there_row_by_row(diagnosis: Diagnosis, table: str) -> None:
    told, rows = getattr(diagnosis, table), diagnosis_json(diagnosis)[table]
    assert len(rows) == next(iter(told.sizes.values()), 0)
    for index, row in enumerate(rows):
        assert row == {str(name): plain(variable.values[index]) for name, variable in told.variables.items()}


def test_every_curve_of_the_page_is_in_a_file(diagnosis: Diagnosis, tmp_path: Path) -> None:
    file = read_tree(write_curves(diagnosis, tmp_path / "curves.nc"))
    assert file.attrs["crashkit_schema"] == "curves/1"
    for name in ("curves", "missing_force"):
        told = getattr(diagnosis, name)
        assert len(told.leaves) > 0
        for node in told.leaves:
            xr.testing.assert_identical(file[f"{name}{node.path}"].to_dataset(inherit=False), node.to_dataset(inherit=False))


def test_without_a_finding_there_are_the_recorded_curves(diagnosis: Diagnosis, tmp_path: Path) -> None:
    nothing = evolve(diagnosis, findings=(), missing_force=xr.DataTree())
    assert set(read_tree(write_curves(nothing, tmp_path / "curves.nc")).children) >= {"curves"}
