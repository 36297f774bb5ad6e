"""Runs a trial: makes each case, seals its answer, has `crashkit diagnose` look at it, opens the seal and scores."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter
from typing import Any

from attrs import asdict, frozen

from benchmarks.blind.make import make
from benchmarks.blind.plan import Ticket
from benchmarks.blind.score import score
from crashkit.testing.concealed import read_answer, write_answer

Record = dict[str, Any]
"""What is known of one case at the end; one line of the file of results."""


@frozen
class Trial:
    """How cases are tried.

    Arguments:
        limit: s that a diagnosis may take; one that takes longer has failed.
        keep: folder for cases, answers and diagnoses; None: they are thrown away.
    """

    limit: float
    keep: Path | None = None

    def __call__(self, ticket: Ticket) -> Record:
        """Make, diagnose and score one case."""
        if self.keep is not None:
            return self._tried(ticket, self.keep)
        with tempfile.TemporaryDirectory() as folder:
            return self._tried(ticket, Path(folder))

    def _tried(self, ticket: Ticket, folder: Path) -> Record:
        case, seal = folder / "cases" / ticket.name, folder / "answers" / f"{ticket.name}.json"
        record: Record = asdict(ticket) | {"status": "not made"}
        answer = make(ticket, case)
        if answer is None:
            return record
        write_answer(answer, seal)
        return record | diagnosed(case, folder / "diagnoses" / ticket.name, self.limit) | _opened(folder, ticket)


def run_trial(tickets: Sequence[Ticket], trial: Trial, results: Path | None, workers: int) -> list[Record]:
    """The records of all tickets, in their order; each is printed and written to `results` as soon as it is there.

    What `results` holds already is not done again; delete a line to have it done again.
    """
    known = {_key(record): record for record in (read_records(results) if results else [])}
    missing = [ticket for ticket in tickets if _key(asdict(ticket)) not in known]
    for record in _as_they_come(trial, missing, workers):
        known[_key(record)] = record
        print(line(record), flush=True)
        if results:
            with results.open("a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")
    return [known[_key(asdict(ticket))] for ticket in tickets]


def read_records(results: Path) -> list[Record]:
    """The lines of a file of results, if it is there."""
    text = results.read_text(encoding="utf-8") if results.exists() else ""
    return [json.loads(one) for one in text.splitlines()]


def diagnosed(case: Path, output: Path, limit: float) -> Record:
    """Run `crashkit diagnose` on a case in a process of its own: `status` ("done", "crashed" or "timed out") and `seconds`."""
    output.mkdir(parents=True, exist_ok=True)
    runs, unseen = (sorted(map(str, case.glob(f"{kind}_*.nc"))) for kind in ("run", "holdout"))
    command = [sys.executable, "-m", "crashkit", "diagnose", str(case / "model.toml"), *runs]
    command += ["--holdout", *unseen, "--output", str(output)]
    start = perf_counter()
    log = output / "log.txt"
    with log.open("w") as file:
        try:
            done = subprocess.run(command, stdout=file, stderr=subprocess.STDOUT, timeout=limit, check=False)
            status = "crashed" if done.returncode else "done"
        except subprocess.TimeoutExpired:
            status = "timed out"
    record: Record = {"status": status, "seconds": perf_counter() - start}
    return record | {"error": log.read_text(encoding="utf-8").splitlines()[-1:]} if status == "crashed" else record


def read_diagnosis(output: Path) -> Record:
    """What a diagnosis said, from the folder that it wrote to."""
    said: Record = json.loads((output / "diagnosis.json").read_text(encoding="utf-8"))
    return said


def _opened(folder: Path, ticket: Ticket) -> Record:
    """The truth, and what was said of it."""
    truth = read_answer(folder / "answers" / f"{ticket.name}.json")
    output = folder / "diagnoses" / ticket.name
    if not (output / "diagnosis.json").exists():
        return {"truth": truth}
    said = read_diagnosis(output)
    fits = {
        f"{runs}_{model}": fit.get("normalised_rmse") for runs, models in said["fit"].items() for model, fit in models.items()
    }
    findings = [
        {key: finding[key] for key in ("physics", "form", "location", "probability") if key in finding}
        for finding in said["findings"]
    ]
    return {"truth": truth, "said": {"verdict": said["verdict"], "findings": findings}, **fits, **score(said, truth).record()}


def _as_they_come(trial: Trial, tickets: Sequence[Ticket], workers: int) -> Iterator[Record]:
    if workers == 1:
        yield from map(trial, tickets)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as executor:
        for future in as_completed([executor.submit(trial, ticket) for ticket in tickets]):
            yield future.result()


def _key(record: Record) -> str:
    return json.dumps([record["name"], list(record["seed"]), list(record["physics"]), record["size"]])


def line(record: Record) -> str:
    """One case in one line."""
    secret = " and ".join(record["physics"]) or "nothing"
    if record["status"] != "done":
        return f"{record['name']}  {record['status']}: {secret}, {record['size']}"
    said = (
        ", ".join(f"{f['physics']} ({f['probability']:.2f})" for f in record["said"]["findings"]) or record["said"]["verdict"]
    )
    mark = "right" if record["right"] else "WRONG"
    return f"{record['name']}  {mark}  {record['seconds']:.0f} s  {secret}, {record['truth']['size'] or '-'}: {said}"
