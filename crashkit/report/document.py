"""The answer for programs: diagnosis.json, schema "crashkit-diagnosis/1", and curves.nc, the curves behind it."""

import json
import math
from collections.abc import Mapping
from pathlib import Path

import attrs
import numpy as np
import xarray as xr

from crashkit.data.netcdf import write_tree
from crashkit.diagnose.result import Diagnosis, Finding, Fit
from crashkit.report.files import write_text

SETS = ("calibration", "holdout")
MODELS = ("before", "after")
TABLES = ("ranking", "identified", "consistency", "detectable")
"""Of a Diagnosis, each a list with an object for each row."""


def write_json(diagnosis: Diagnosis, path: Path) -> Path:
    """Write the diagnosis as JSON, whole or not at all, and return its path."""
    text = json.dumps(diagnosis_json(diagnosis), indent=1, ensure_ascii=False, allow_nan=False)
    return write_text(path, text + "\n")


def write_curves(diagnosis: Diagnosis, path: Path) -> Path:
    """Write what the page draws as netCDF, whole or not at all, and return its path.

    The file has a group `curves/run/instrument` for each recording, and `missing_force/finding/run` for each finding in the
    structure ("0", ...), as `Diagnosis` has them.
    """
    groups = {"curves": diagnosis.curves, "missing_force": diagnosis.missing_force}
    write_tree(xr.DataTree(xr.Dataset(attrs={"crashkit_schema": "curves/1"}), groups), path)
    return path


def diagnosis_json(diagnosis: Diagnosis) -> dict[str, object]:
    """The diagnosis as plain JSON values; what is not finite becomes null, a set of runs that is not there {}."""
    document = {
        "schema": "crashkit-diagnosis/1",
        "verdict": diagnosis.verdict,
        "findings": [_finding(finding) for finding in diagnosis.findings],
        "fit": {runs: {model: _fit(diagnosis.fits.get(runs, {}).get(model)) for model in MODELS} for runs in SETS},
        "augmented_model": "augmented_model.toml",
        "summary": diagnosis.summary,
        "notes": list(diagnosis.notes),
        **{name: _rows(getattr(diagnosis, name)) for name in TABLES},
    }
    return {key: plain(value) for key, value in document.items()}


def _finding(finding: Finding) -> dict[str, object]:
    return attrs.asdict(finding)


def _fit(fit: Fit | None) -> dict[str, object]:
    if fit is None:
        return {}
    table = fit.channels
    names = [str(name) for name in table["channel"].values] if "channel" in table.sizes else []
    measures = [name for name, variable in table.data_vars.items() if variable.dims == ("channel",)]
    channels = {
        channel: {measure: table.variables[measure].values[index] for measure in measures}
        for index, channel in enumerate(names)
    }
    expected = {"expected_rmse": fit.expected_rmse, "untold": fit.untold} if fit.untold else {}
    together = {} if math.isnan(fit.together_rmse) else {"together_rmse": fit.together_rmse}
    return {"normalised_rmse": fit.normalised_rmse, **expected, **together, "channels": channels}


def _rows(table: xr.Dataset) -> list[dict[str, object]]:
    columns = {str(name): variable.values.tolist() for name, variable in table.variables.items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def plain(value: object) -> object:
    """Values that JSON knows."""
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(entry) for entry in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if isinstance(value, bool | int | None) else str(value)
