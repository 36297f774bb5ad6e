"""The paper's study, done again and taken further; writes the folder docs/paper-study.

`CRASHKIT_STARTS` random starts of each kind (20).
"""

import os
from pathlib import Path
from string import Template

from benchmarks import Row
from benchmarks.paper import beyond, figures, plane, tables

STARTS = int(os.environ.get("CRASHKIT_STARTS", "20"))
FOLDER = Path(__file__).parent.parent.parent / "docs" / "paper-study"


def run() -> list[Row]:
    """A row for each line of the paper's tables, with the paper's own error, and one for each kind of start."""
    found = tables.lines()
    FOLDER.mkdir(exist_ok=True)
    figures.draw(FOLDER)
    shares = beyond.far_starts(STARTS)
    _write(
        tables=tables.as_markdown(found),
        starts=_starts(shares),
        noise=beyond.noise_table(),
        prediction=beyond.prediction_table(),
        structures=beyond.structures_table(),
        plane=plane.as_markdown(),
    )
    rows = [_row(line) for line in found]
    return rows + [
        Row(f"{share.toy}: {share.method}, {share.start}, all to 1e-8", "rate", "1", share.found / share.of, "", None)
        for share in shares
    ]


def _row(line: tables.Line) -> Row:
    case = line.case
    told = f"Table {case.table}, {case.title}: {line.method}, largest error"
    theirs = tables.worst(case, tables.reached(case))
    return Row(told, "error", "1", line.error, f"the paper: {case.method}", theirs)


def _starts(shares: list[beyond.Share]) -> str:
    head = "| | start | method | all parameters to 1e-8 |\n| --- | --- | --- | --- |"
    return "\n".join([head, *(f"| {s.toy} | {s.start} | {s.method} | {s.found} of {s.of} |" for s in shares)])


def _write(**parts: str) -> None:
    page = Template((Path(__file__).parent / "page.md").read_text(encoding="utf-8"))
    (FOLDER / "index.md").write_text(page.substitute(parts), encoding="utf-8")
