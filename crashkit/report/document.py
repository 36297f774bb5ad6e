"""diagnosis.json: the answer for programs, schema "crashkit-diagnosis/1"."""

import json
import math
from collections.abc import Mapping
from pathlib import Path

import attrs
import numpy as np

from crashkit.diagnose.result import Diagnosis, Finding, Fit
from crashkit.report.files import write_text

SETS = ("calibration", "holdout")
MODELS = ("before", "after")


def write_json(diagnosis: Diagnosis, path: Path) -> Path:
    """Write the diagnosis as JSON, whole or not at all, and return its path."""
    text = json.dumps(diagnosis_json(diagnosis), indent=1, ensure_ascii=False, allow_nan=False)
    return write_text(path, text + "\n")


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
