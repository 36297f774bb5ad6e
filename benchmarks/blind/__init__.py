"""The blind trial: concealed cases from a world that shares nothing with the engine, diagnosed, then unsealed and scored.

`python -m benchmarks blind --cases 200 --seed N --json FILE` writes one line for each case to FILE with the ending .jsonl as
it comes, and goes on there when it is started again; at the end FILE holds the shares that are right, and FILE with the
ending .md the tables. `python -m benchmarks.blind.make` only makes cases.
"""

import os
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks import Row

AIMS = {"small": None, "middle": 0.95, "gross": 0.95}
"""Shares of the cases with something concealed that should be right."""
FALSE_ALARMS = 0.01
SECONDS = 30.0
HELD_OUT = 1.05


def add_arguments(parser: ArgumentParser) -> None:
    """The options of the trial."""
    from benchmarks.blind.make import add_choices

    add_choices(parser)
    parser.add_argument("--workers", metavar="W", type=int, default=max(1, (os.cpu_count() or 2) // 2), help="(%(default)s)")
    parser.add_argument("--limit", metavar="S", type=float, default=600.0, help="s that a diagnosis may take (%(default)s)")
    parser.add_argument("--keep", metavar="DIR", type=Path, help="keep cases, answers and diagnoses there")


def run(options: Namespace) -> list[Row]:
    """Run the trial; what was right, beside what is aimed at."""
    from benchmarks.blind.plan import plan
    from benchmarks.blind.tables import report
    from benchmarks.blind.trial import Trial, run_trial

    tickets = plan(options.cases, options.seed, options.only, options.sizes)
    results = options.json.with_suffix(".jsonl") if options.json else None
    records = run_trial(tickets, Trial(options.limit, options.keep), results, options.workers)
    text = report(records)
    print(text, end="\n\n")
    if options.json:
        options.json.with_suffix(".md").write_text(text + "\n", encoding="utf-8")
    return rows([record for record in records if record["status"] != "not made"])


def rows(records: Sequence[dict[str, Any]]) -> list[Row]:
    """The shares that are right by size, the false alarms, the held-out residual where known physics was named, the time."""
    nulls = [record for record in records if not record["physics"]]
    found = [r["holdout_after"] for r in records if r["physics"] and r.get("right") and r.get("holdout_after") is not None]
    times = [record["seconds"] for record in records if record["status"] == "done"]
    table = [
        Row(f"{size}: right of {len(group)}", "rate", "1", _share(group, "right"), "aim", aim)
        for size, aim in AIMS.items()
        if (group := [record for record in records if record["physics"] and record["truth"]["size"] == size])
    ]
    if nulls:
        alarms = sum(bool(record.get("said", {}).get("findings")) for record in nulls) / len(nulls)
        table.append(Row(f"nothing: false alarms in {len(nulls)}", "error", "1", alarms, "aim", FALSE_ALARMS))
    if found:
        table.append(Row("held-out residual over noise where right, median", "error", "1", median(found), "aim", HELD_OUT))
    if times:
        table.append(Row("diagnosis, median", "time", "s", median(times), "aim", SECONDS))
    return table


def _share(group: Sequence[dict[str, Any]], key: str) -> float:
    return sum(bool(record.get(key, False)) for record in group) / len(group)
