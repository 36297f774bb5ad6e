"""How often a diagnosis is right: every case of a folder whose secret is known, with its time and its gain on held-out runs.

The environment variable CRASHKIT_CASES names the folder (else ../shared/cases beside the checkout). Each case is a folder of
its own with model.toml, run_*.nc, holdout_*.nc and truth.json: `accept` lists [physics, kind of place, place], of which one,
or with `all` each, must be found; ["consistent", null, null] where nothing is concealed.
"""

import json
import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from time import perf_counter

from benchmarks import Row
from crashkit.api import diagnose_files
from crashkit.diagnose import Diagnosis

VERDICTS = {"sensor": "sensor_fault", "instrument": "sensor_fault"}
"""The verdict that a kind of place asks for, where it is not missing physics."""


def run() -> list[Row]:
    """Three rows for each case: what is wrong with the answer, the residual of the held-out runs, and the time."""
    return [row for folder in folders() for row in _rows(folder)]


def folders() -> list[Path]:
    """The cases."""
    beside = Path(__file__).parent.parent.parent / "shared" / "cases"
    return sorted(path.parent for path in Path(os.environ.get("CRASHKIT_CASES", beside)).glob("*/truth.json"))


def diagnosed(folder: Path, output: Path) -> Diagnosis:
    """The answer to one case, which never sees its truth."""
    runs, unseen = (sorted(folder.glob(f"{kind}_*.nc")) for kind in ("run", "holdout"))
    return diagnose_files(folder / "model.toml", runs, unseen, output, lambda sentence: None)


def faults(answer: Diagnosis, truth: Mapping[str, object]) -> list[str]:
    """What is wrong with an answer, in words; empty where it is right."""
    accepted: Iterable[tuple[str, str, object]] = truth["accept"]  # type: ignore[assignment]
    wanted = [_claim(physics, {kind: place}) for physics, kind, place in accepted if physics != "consistent"]
    found = [_claim(finding.physics, finding.location) for finding in answer.findings]
    missing = [claim for claim in wanted if claim not in found]
    if not truth["all"] and len(missing) < len(wanted):
        missing = []
    verdicts = {_verdict(wanted, bool(truth["all"]), claim) for claim in wanted} or {"consistent"}
    wrong = [f"verdict {answer.verdict}"] if answer.verdict not in verdicts else []
    return [*wrong, *(f"missing {claim}" for claim in missing), *(f"spurious {c}" for c in found if c not in wanted)]


def _claim(physics: str, location: Mapping[str, object]) -> tuple[str, str, object]:
    kind = next(key for key in ("joint", "bodies", "body", "sensor", "instrument") if key in location)
    place = location[kind]
    return physics, kind, sorted(place) if isinstance(place, list) else place


def _verdict(wanted: list[tuple[str, str, object]], together: bool, claim: tuple[str, str, object]) -> str:
    """Of several effects at once the structural ones decide."""
    claims = wanted if together else [claim]
    kinds = [kind for physics, kind, _ in claims if physics != "unknown"]
    structural = [kind for kind in kinds if kind not in VERDICTS]
    if structural:
        return "missing_physics"
    return VERDICTS[kinds[0]] if len(kinds) == len(claims) else "unexplained"


def _rows(folder: Path) -> list[Row]:
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as output:
        start = perf_counter()
        answer = diagnosed(folder, Path(output))
        elapsed = perf_counter() - start
    wrong = faults(answer, truth)
    unseen = answer.fits["holdout"]
    case = f"{folder.name} ({', '.join(wrong) or 'right'})"
    return [
        Row(case, "error", "wrong claims", float(len(wrong)), "truth", 0.0),
        Row(
            f"{folder.name}: held-out residual over noise",
            "error",
            "1",
            unseen["after"].normalised_rmse,
            "re-identified model",
            unseen["before"].normalised_rmse,
        ),
        Row(f"{folder.name}: diagnosis", "time", "s", elapsed, "", None),
    ]
