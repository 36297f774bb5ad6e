"""Tables 1 to 4: every method from every start, beside the paper's results."""

import os
from time import process_time

import numpy as np
from attrs import frozen

from benchmarks.identification import searched
from benchmarks.paper.cases import CASES, NOMINAL, Case, numbers, problem_of, truth_of
from crashkit.registry import load
from crashkit.testing.toys import RHO

PATIENCE = float(os.environ.get("CRASHKIT_PATIENCE", "20"))
"""s of computing that a method is given."""


THRESHOLD_PLACES = (2, 3, 6, 7)
"""Of γ and δ, among the parameters of one spring or two."""
UNSEEN = (5, 6)
"""Places of β2 and γ2, which a run at speed 1 does not see when the masses are as printed."""


@frozen(eq=False)
class Line:
    """What one method found from one start: the parameters in the paper's units, and its seconds of computing."""

    case: Case
    printed: bool
    method: str
    values: np.ndarray
    elapsed: float

    @property
    def error(self) -> float:
        """The largest relative error."""
        return worst(self.case, self.values, self.printed)


def worst(case: Case, values: np.ndarray, printed: bool = False) -> float:
    """The largest relative error of a parameter that can be seen."""
    truth = np.array(NOMINAL if case.is_single else (*NOMINAL, *NOMINAL, 0.7))
    errors = np.abs(values / truth - 1.0)
    return float((np.delete(errors, UNSEEN) if printed else errors).max())


def readings(case: Case) -> tuple[bool, ...]:
    """Whether the masses are as printed: both, where there are two masses."""
    return (False,) if case.is_single else (False, True)


def lines() -> list[Line]:
    """Every case, in both readings of the masses, by every installed method."""
    return [_line(case, printed, method) for case in CASES for printed in readings(case) for method in load().identifiers]


def as_markdown(found: list[Line], printed: bool) -> str:
    """One table for each case."""
    cases = [case for case in CASES if printed in readings(case)]
    return "\n\n".join(
        _table(case, [line for line in found if line.case == case and line.printed == printed], printed) for case in cases
    )


def _line(case: Case, printed: bool, method: str) -> Line:
    misfit = problem_of(case, printed)
    begin = process_time()
    values = searched(load().identifier(method)(), misfit, PATIENCE)
    elapsed = process_time() - begin
    model = truth_of(case, printed).at(dict(zip(misfit.names, values.tolist(), strict=True)))
    return Line(case, printed, method, numbers(model, printed), elapsed)


def _table(case: Case, own: list[Line], printed: bool) -> str:
    rho = () if case.is_single else (RHO,)
    paper = worst(case, reached(case), printed)
    rows = [_row("start", started(case), None), _row(f"*the paper: {case.method}*", case.reached, paper)]
    rows += [_row(line.method, (*line.values, *rho), line.error) for line in own]
    head = ["", *case.names, *("ρ" for _ in rho), "largest error"]
    told = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    return "\n".join([f"**Table {case.table}, {case.title}**", "", *told, *rows])


def started(case: Case) -> tuple[float, ...]:
    """The start; thresholds that are known start where they are."""
    known = {place: (*NOMINAL, *NOMINAL)[place] for place in THRESHOLD_PLACES} if case.clamped else {}
    return tuple(known.get(place, value) for place, value in enumerate(case.first))


def reached(case: Case) -> np.ndarray:
    """What the paper reached, without ρ."""
    return np.array(case.reached[: len(case.names)])


def _row(name: str, values: tuple[float, ...], error: float | None) -> str:
    cells = [name, *(f"{value:.4g}" for value in values), "" if error is None else f"{error:.1e}"]
    return "| " + " | ".join(cells) + " |"
