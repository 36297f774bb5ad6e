"""What a trial comes to, as tables in Markdown."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from statistics import median
from typing import Any

from benchmarks.blind.score import words
from benchmarks.blind.trial import Record
from crashkit.testing.concealed import HIDDEN, SIZES

BINS = (0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 1.0)
"""Edges of the probabilities of the reliability table."""


def report(records: Sequence[Record]) -> str:
    """All tables."""
    made = [record for record in records if record["status"] != "not made"]
    parts = {
        "By size": by_size(made),
        "By physics": by_physics(made),
        "Concealed and named": confusion(made),
        "Reliability": reliability(made),
        "Not right": failures(made),
    }
    return "\n\n".join(f"### {title}\n\n{table}" for title, table in parts.items())


def kind_of(record: Record) -> str:
    """ "nothing", "pair", or the one physics."""
    return "pair" if len(record["physics"]) > 1 else next(iter(record["physics"]), "nothing")


def by_size(records: Sequence[Record]) -> str:
    """One line for nothing concealed, one for each size."""
    groups = {"nothing": [r for r in records if not r["physics"]]}
    groups |= {size: [r for r in records if r["physics"] and r["truth"]["size"] == size] for size in (HIDDEN, *SIZES)}
    return _table(_HEAD, [_summary(name, group) for name, group in groups.items() if group])


def by_physics(records: Sequence[Record]) -> str:
    """One line for each physics, all sizes together, with how many of each size were right."""
    head = (*_HEAD, *(f"{size} right" for size in SIZES))
    rows = []
    for kind in sorted({kind_of(record) for record in records} - {"nothing"}):
        group = [record for record in records if kind_of(record) == kind]
        sized = [[record for record in group if record["truth"]["size"] == size] for size in SIZES]
        rows.append([*_summary(kind, group), *(f"{_count(part, 'right')}/{len(part)}" for part in sized)])
    return _table(head, rows)


def confusion(records: Sequence[Record]) -> str:
    """For each thing concealed alone: what was said, the places apart."""
    rows = []
    for kind in sorted({kind_of(record) for record in records} - {"pair"}):
        said = Counter(_said(record) for record in records if kind_of(record) == kind)
        rows.append([kind, ", ".join(f"{name} {count}" for name, count in said.most_common())])
    return _table(("concealed", "said"), rows)


def reliability(records: Sequence[Record]) -> str:
    """How often what was given a probability is there: physics and place."""
    claims = [claim for record in records for claim in record.get("claims", ())]
    rows = []
    for low, high in zip(BINS, BINS[1:], strict=False):
        inside = [(p, there) for p, there in claims if low <= p < high or p == high == 1.0]
        if inside:
            mean, share = (sum(column) / len(inside) for column in zip(*inside, strict=True))
            rows.append([f"{low:g} to {high:g}", len(inside), f"{mean:.3f}", f"{share:.3f}"])
    return _table(("probability", "findings", "mean probability", "share that is there"), rows)


def failures(records: Sequence[Record]) -> str:
    """Every case that is not right: what was concealed, what was said."""
    rows = [
        [record["name"], record["truth"]["size"] or "-", _secrets(record), _answer(record)]
        for record in records
        if not record.get("right", False)
    ]
    return _table(("case", "size", "concealed", "said"), rows)


_HEAD = (
    "concealed",
    "cases",
    "right",
    "verdict",
    "physics",
    "place",
    "nothing spurious",
    "failed",
    "held out before",
    "after",
    "seconds",
)


def _summary(name: str, group: Sequence[Record]) -> list[Any]:
    counts = [_count(group, key) for key in ("right", "verdict_right", "physics_right", "place_right")]
    clean = sum(record["status"] == "done" and not record["spurious"] for record in group)
    failed = sum(record["status"] != "done" for record in group)
    middles = [_middle(group, key) for key in ("holdout_before", "holdout_after", "seconds")]
    return [name, len(group), *counts, clean, failed, *middles]


def _count(group: Iterable[Record], key: str) -> int:
    return sum(bool(record.get(key, False)) for record in group)


def _middle(group: Iterable[Record], key: str) -> str:
    values = [record[key] for record in group if record.get(key) is not None]
    return f"{median(values):.3g}" if values else "-"


def _said(record: Record) -> str:
    if record["status"] != "done":
        return str(record["status"])
    names = sorted(finding["physics"] for finding in record["said"]["findings"])
    return " + ".join(names) or str(record["said"]["verdict"])


def _secrets(record: Record) -> str:
    told = [
        words((f"{secret['physics']} ({secret['form']}, {secret['left']:.0f} sigma)", secret["kind"], secret["place"]))
        for secret in record["truth"]["secrets"]
    ]
    return "; ".join(told) or "nothing"


def _answer(record: Record) -> str:
    if record["status"] != "done":
        return str(record["status"])
    places: Callable[[dict[str, Any]], str] = lambda finding: " ".join(map(str, finding["location"].values()))  # noqa: E731
    told = [f"{f['physics']} at {places(f)} ({f['probability']:.2f})" for f in record["said"]["findings"]]
    return "; ".join(told) or str(record["said"]["verdict"])


def _table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)
