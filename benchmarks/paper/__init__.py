"""The paper's study, done again and taken further; writes the folder docs/paper-study.

`CRASHKIT_STARTS` random starts of each kind (20), of which the slow methods get `CRASHKIT_SLOW_STARTS` (3); a search is given
`CRASHKIT_PATIENCE` seconds of computing (20).
"""

import os
from pathlib import Path
from string import Template

from benchmarks import Row
from benchmarks.paper import beyond, figures, plane, plane_search, tables

STARTS, SLOW_STARTS = int(os.environ.get("CRASHKIT_STARTS", "20")), int(os.environ.get("CRASHKIT_SLOW_STARTS", "3"))
FOLDER = Path(__file__).parent.parent.parent / "docs" / "paper-study"
EXACT, CLOSE = 1e-8, 1e-2
"""Largest relative error of a parameter that counts as found, and as nearly found."""


def run() -> list[Row]:
    """A row for each line of the paper's tables, with the paper's own error, and one for each kind of start."""
    found = tables.lines()
    FOLDER.mkdir(exist_ok=True)
    figures.draw(FOLDER)
    shares = beyond.far_starts(STARTS, SLOW_STARTS)
    _write(
        tables=tables.as_markdown(found, printed=False),
        printed=tables.as_markdown(found, printed=True),
        starts=_starts(shares),
        noise=beyond.noise_table(),
        prediction=beyond.prediction_table(),
        structures=beyond.structures_table(),
        plane=plane.as_markdown(),
        plane_search=plane_search.as_markdown(),
    )
    return [*map(_row, found), *map(_share_row, shares)]


def _row(line: tables.Line) -> Row:
    case, masses = line.case, ", masses as printed" if line.printed else ""
    told = f"Table {case.table}, {case.title}{masses}: {line.method}, largest error"
    theirs = tables.worst(case, tables.reached(case), line.printed)
    return Row(told, "error", "1", line.error, f"the paper: {case.method}", theirs)


def _share_row(share: beyond.Share) -> Row:
    told = f"{share.toy}: {share.method}, {share.start}, all to {EXACT:g} from {len(share.errors)} starts"
    return Row(told, "rate", "1", share.rate(EXACT), "", None)


def _starts(shares: list[beyond.Share]) -> str:
    """For each toy, how many of the starts of each kind every method arrives from."""
    blocks = []
    for toy in dict.fromkeys(share.toy for share in shares):
        own = [share for share in shares if share.toy == toy]
        head = ["", *beyond.KINDS]
        rows = [_cells([method, *(_counts(s) for s in own if s.method == method)]) for method in _methods(own)]
        blocks.append("\n".join([f"**{toy}**", "", _cells(head), "|" + " --- |" * len(head), *rows]))
    return "\n\n".join(blocks)


def _methods(shares: list[beyond.Share]) -> list[str]:
    return list(dict.fromkeys(share.method for share in shares))


def _counts(share: beyond.Share) -> str:
    exact, close = (round(share.rate(limit) * len(share.errors)) for limit in (EXACT, CLOSE))
    return f"{exact}, {close} of {len(share.errors)}"


def _cells(cells: list[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _write(**parts: str) -> None:
    page = Template((Path(__file__).parent / "page.md").read_text(encoding="utf-8"))
    (FOLDER / "index.md").write_text(page.substitute(parts), encoding="utf-8")
