"""Tables 1 to 4: every method from every start, beside the paper's results."""

import os
from time import process_time

import numpy as np
from attrs import frozen

from benchmarks.identification import searched
from benchmarks.paper.cases import CASES, NOMINAL, Case, numbers, problem_of, truth_of
from crashkit.registry import load

PATIENCE = float(os.environ.get("CRASHKIT_PATIENCE", "60"))
"""s of computing that a method is given."""


@frozen(eq=False)
class Line:
    """What one method found from one start: the parameters in the paper's units, and its seconds of computing."""

    case: Case
    method: str
    values: np.ndarray
    elapsed: float

    @property
    def error(self) -> float:
        """The largest relative error."""
        return worst(self.case, self.values)


def worst(case: Case, values: np.ndarray) -> float:
    """The largest relative error of a parameter."""
    truth = np.array(NOMINAL if case.is_single else (*NOMINAL, *NOMINAL, 0.7))
    return float(np.abs(values / truth - 1.0).max())


def lines() -> list[Line]:
    """Every case by every installed method."""
    return [_line(case, method) for case in CASES for method in load().identifiers]


def as_markdown(found: list[Line]) -> str:
    """One table for each case."""
    return "\n\n".join(_table(case, [line for line in found if line.case == case]) for case in CASES)


def _line(case: Case, method: str) -> Line:
    misfit = problem_of(case)
    begin = process_time()
    values = searched(load().identifier(method)(), misfit, PATIENCE)
    elapsed = process_time() - begin
    model = truth_of(case).with_values(dict(zip(misfit.names, values.tolist(), strict=True)))
    return Line(case, method, numbers(model), elapsed)


def _table(case: Case, own: list[Line]) -> str:
    rows = [_row("start", case.first, None), _row(f"the paper: {case.method}", case.reached, worst(case, reached(case)))]
    rows += [_row(line.method, tuple(line.values), line.error) for line in own]
    head = ["", *case.names, "largest error"]
    told = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    return "\n".join([f"**Table {case.table}, {case.title}**", "", *told, *rows])


def reached(case: Case) -> np.ndarray:
    """What the paper reached, without ρ."""
    return np.array(case.reached[: len(case.names)])


def _row(name: str, values: tuple[float, ...], error: float | None) -> str:
    count = 4 if len(values) == 4 else 9
    cells = [name, *(f"{value:.4g}" for value in values[:count]), "" if error is None else f"{error:.1e}"]
    return "| " + " | ".join(cells) + " |"
