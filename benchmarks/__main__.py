"""`python -m benchmarks [NAME] [--json FILE]`: runs one study, or lists them.

A study that has options of its own adds them in `add_arguments(parser)`, and its `run` is given them.
"""

import json
from argparse import ArgumentParser
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from benchmarks import Row
from crashkit.cli import use_one_thread

COLUMNS = ("case", "measure", "unit", "ours", "peer", "theirs", "ratio")


def main(argv: Sequence[str] | None = None) -> None:
    """Run a study, print its table, write its JSON."""
    use_one_thread()
    names = [module.name for module in iter_modules([str(Path(__file__).parent)]) if not module.name.startswith("_")]
    first = ArgumentParser("python -m benchmarks", add_help=False)
    first.add_argument("name", nargs="?", choices=names, help="the study; omitted: list them")
    first.add_argument("--json", metavar="FILE", type=Path, help="where to write the rows")
    parser = ArgumentParser("python -m benchmarks", description="Measures crashkit beside its peers.", parents=[first])
    name = first.parse_known_args(argv)[0].name
    if name is None:
        parser.parse_args(argv)
        print("\n".join(names))
        return
    study = import_module(f"benchmarks.{name}")
    has_options = hasattr(study, "add_arguments")
    if has_options:
        study.add_arguments(parser)
    arguments = parser.parse_args(argv)
    rows = [as_dict(row) for row in (study.run(arguments) if has_options else study.run())]
    print(table(rows))
    if arguments.json:
        arguments.json.write_text(json.dumps({"benchmark": arguments.name, "rows": rows}, indent=1) + "\n")


def as_dict(row: Row) -> dict[str, object]:
    """A row as the JSON holds it."""
    return {column: getattr(row, column) for column in COLUMNS}


def table(rows: Sequence[dict[str, object]]) -> str:
    """The rows in columns."""
    cells = [COLUMNS, *(tuple(_cell(row[column]) for column in COLUMNS) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)) for line in cells)
    return "\n".join(line.rstrip() for line in lines)


def _cell(value: object) -> str:
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main()
