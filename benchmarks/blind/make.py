"""Makes cases without diagnosing them: `python -m benchmarks.blind.make --cases N --seed S DIR`.

DIR/cases/NAME holds what a diagnosis may see, DIR/answers/NAME.json what was concealed: sealed, or with `--open` to be read.
"""

from argparse import ArgumentParser
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.blind.plan import SHARES, Ticket, plan
from crashkit.testing.concealed import EFFECTS, SIZES, make_case, write_answer, write_case

ATTEMPTS = 5
"""How many seeds are tried for a ticket: not every pair or size can be had."""


def main(argv: Sequence[str] | None = None) -> None:
    """Make cases and put their answers apart."""
    parser = ArgumentParser("python -m benchmarks.blind.make", description=__doc__)
    add_choices(parser)
    parser.add_argument("--open", dest="sealed", action="store_false", help="write the answers so that they can be read")
    parser.add_argument("folder", metavar="DIR", type=Path)
    options = parser.parse_args(argv)
    for ticket in plan(options.cases, options.seed, options.only, options.sizes):
        answer = make(ticket, options.folder / "cases" / ticket.name)
        if answer is None:
            print(f"{ticket.name} cannot be had")
            continue
        write_answer(answer, options.folder / "answers" / f"{ticket.name}.json", options.sealed)
        print(ticket.name, flush=True)


def add_choices(parser: ArgumentParser) -> None:
    """The options that say which cases are made."""
    parser.add_argument("--cases", metavar="N", type=int, default=20, help="how many (%(default)s)")
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of everything random (%(default)s)")
    names = (*SHARES, *EFFECTS)
    parser.add_argument("--only", metavar="PHYSICS", nargs="+", choices=names, default=(), help="of " + ", ".join(names))
    parser.add_argument("--sizes", nargs="+", choices=SIZES, default=tuple(SIZES), help="how visible (all)")


def make(ticket: Ticket, folder: Path) -> dict[str, Any] | None:
    """Write a ticket's case; returns its answer, None if it cannot be had."""
    for attempt in range(ATTEMPTS):
        try:
            case = make_case((*ticket.seed, attempt), ticket.physics, ticket.size)
        except ValueError:
            continue
        write_case(case, folder)
        return case.answer
    return None


if __name__ == "__main__":
    main()
