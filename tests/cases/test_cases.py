"""Concealed physics in made-up recordings: the diagnosis names it, finds its place, and claims nothing else."""

import json
import os
from pathlib import Path

import pytest

from benchmarks.blind.score import score
from crashkit.api import diagnose_files

BESIDE = Path(__file__).parents[3] / "shared" / "cases"
FOLDER = Path(os.environ.get("CRASHKIT_CASES", BESIDE))
NAMES = sorted(path.parent.name for path in FOLDER.glob("*/truth.json"))
ALWAYS = ("sample_null", "sample_gain", "sample_clearance")
"""What runs without being asked for."""

pytestmark = [pytest.mark.cases, pytest.mark.slow]


@pytest.mark.parametrize("name", NAMES or ["none"])
def test_a_case_is_solved(cases, request, tmp_path, name):
    if name not in ALWAYS and "cases" not in request.config.getoption("markexpr"):
        pytest.skip("a minute each: run with -m cases")
    folder = cases / name
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    runs, unseen = (sorted(folder.glob(f"{kind}_*.nc")) for kind in ("run", "holdout"))
    answer = diagnose_files(folder / "model.toml", runs, unseen, tmp_path, lambda sentence: None)
    found = score(json.loads((tmp_path / "diagnosis.json").read_text(encoding="utf-8")), truth)
    assert found.right, f"expected {truth['accept']}: {found}"
    before, after = (answer.fits["holdout"][when].normalised_rmse for when in ("before", "after"))
    assert after <= before * 1.001, "held-out runs: expected a better prediction, or the same where nothing was found"
