"""How often a diagnosis is right: every case of a folder whose secret is known, with its time and its gain on held-out runs.

The environment variable CRASHKIT_CASES names the folder (else ../shared/cases beside the checkout). Each case is a folder of
its own with model.toml, run_*.nc, holdout_*.nc and truth.json: `accept` lists [physics, kind of place, place], of which one,
or with `all` each, must be found; ["consistent", null, null] where nothing is concealed.
"""

import json
import os
import tempfile
from pathlib import Path
from time import perf_counter

from benchmarks import Row
from benchmarks.blind.score import Score, score
from crashkit.api import diagnose_files


def run() -> list[Row]:
    """Three rows for each case: what is wrong with the answer, the residual of the held-out runs, and the time."""
    return [row for folder in folders() for row in _rows(folder)]


def folders() -> list[Path]:
    """The cases."""
    beside = Path(__file__).parent.parent.parent / "shared" / "cases"
    return sorted(path.parent for path in Path(os.environ.get("CRASHKIT_CASES", beside)).glob("*/truth.json"))


def _rows(folder: Path) -> list[Row]:
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    runs, unseen = (sorted(folder.glob(f"{kind}_*.nc")) for kind in ("run", "holdout"))
    with tempfile.TemporaryDirectory() as output:
        start = perf_counter()
        diagnose_files(folder / "model.toml", runs, unseen, Path(output), lambda sentence: None)
        elapsed = perf_counter() - start
        answer = json.loads((Path(output) / "diagnosis.json").read_text(encoding="utf-8"))
    wrong = _wrong(score(answer, truth))
    residual = answer["fit"]["holdout"]
    case = f"{folder.name} ({', '.join(wrong) or 'right'})"
    return [
        Row(case, "error", "wrong claims", float(len(wrong)), "truth", 0.0),
        Row(
            f"{folder.name}: held-out residual over noise",
            "error",
            "1",
            residual["after"]["normalised_rmse"],
            "re-identified model",
            residual["before"]["normalised_rmse"],
        ),
        Row(f"{folder.name}: diagnosis", "time", "s", elapsed, "", None),
    ]


def _wrong(answer: Score) -> list[str]:
    """In words; empty where the answer is right."""
    right = {"verdict": answer.verdict_right, "physics": answer.physics_right, "place": answer.place_right}
    wrong = [f"wrong {what}" for what, is_right in right.items() if not is_right]
    return [*wrong, *(f"spurious {claim}" for claim in answer.spurious)]
