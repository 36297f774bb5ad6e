"""Identification of the paper's toys from random starts within 50 %: how often it arrives, and how long it takes.

Of the paper's ten parameters of two degrees of freedom the motion tells nine: the tenth, ρ, only multiplies three of them. The
nine are searched with ρ known, and all ten, for which errors are of what can be told, the products among it.

Times are of computing, on one core, so that other work on the machine does not count.

`CRASHKIT_STARTS` starts of ours (100), of which the peers get the first `CRASHKIT_PEER_STARTS` (5), as they take that long.
"""

import math
import os
from collections.abc import Callable, Sequence
from statistics import median
from time import process_time

import numpy as np
from attrs import define, field

from benchmarks import Row
from benchmarks._identification import LMFIT, PEERS, evolved
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit.protocols import Identifier, Status
from crashkit.registry import load
from crashkit.testing import toys

STARTS = int(os.environ.get("CRASHKIT_STARTS", "100"))
PEER_STARTS = int(os.environ.get("CRASHKIT_PEER_STARTS", "5"))
EXACT, CLOSE = 1e-8, 1e-3
"""Largest relative error of a parameter that counts as found: ours, and a peer's."""
EVOLVED = "scipy differential_evolution"
ONE, NINE, TEN = "one degree, 4 parameters", "two degrees, 9 parameters", "two degrees, 10 parameters"
_TWO_DEGREES = toys.two_degrees(rear_mass=toys.REAR_MASS_INVERTED)
TOYS: dict[str, Model] = {
    ONE: toys.one_degree(),
    NINE: _TWO_DEGREES,
    TEN: toys.with_ten_parameters(_TWO_DEGREES),
}
RATIO = "joint.second.ratio"
MULTIPLIED = ("joint.second.elastic_stiffness", "joint.second.crush_force", "joint.second.densification_stiffness")


@define
class Tally:
    """The errors and times of one method."""

    errors: list[float] = field(factory=list)
    times: list[float] = field(factory=list)

    def rate(self, limit: float) -> float:
        """Share of the starts from which all parameters were found."""
        return sum(error < limit for error in self.errors) / len(self.errors)


def run() -> list[Row]:
    """Rows of every toy."""
    return [row for case, truth in TOYS.items() for row in _rows(case, truth)]


def problem(truth: Model, speeds: tuple[float, ...] = (1.0,)) -> Misfit:
    """Film and accelerometers of a toy, without noise, started at the truth."""
    registry = load()
    laws = {**registry.spring_laws, toys.StiffnessRatio.name: toys.StiffnessRatio}
    return toys.problem(truth, truth, laws, registry.observers, speeds, exact=True)


def told(names: Sequence[str], values: np.ndarray) -> np.ndarray:
    """What the motion can tell: the parameters, three of them times ρ where ρ is a parameter of its own."""
    known = dict(zip(names, values.tolist(), strict=True))
    ratio = known.pop(RATIO, 1.0)
    return np.array([value * (ratio if name in MULTIPLIED else 1.0) for name, value in known.items()])


def searched(identifier: Identifier[object], misfit: Misfit, most: float = math.inf) -> np.ndarray:
    """Where a method ends, or where it is after so many seconds of computing."""
    begin = process_time()
    state = identifier.start(misfit)
    while state.status is Status.RUNNING and process_time() - begin < most:  # type: ignore[attr-defined]
        state = identifier.step(misfit, state)
    return misfit.parameters(state.point)  # type: ignore[attr-defined]


def _rows(case: str, truth: Model) -> list[Row]:
    misfit, random = problem(truth), np.random.default_rng(0)
    exact = misfit.parameters(misfit.start())
    tallies: dict[str, Tally] = {}
    for number in range(STARTS):
        start = misfit.with_values(dict(zip(misfit.names, exact * random.uniform(0.5, 1.5, len(exact)), strict=True)))
        for name, solve in _methods(start, number).items():
            begin = process_time()
            found = solve()
            tally = tallies.setdefault(name, Tally())
            tally.times.append(process_time() - begin)
            tally.errors.append(float(np.abs(told(misfit.names, found) / told(misfit.names, exact) - 1.0).max()))
    ours = {name: tallies.pop(name) for name in load().identifiers if name in tallies}
    return [row for name in ours for row in _compared(case, name, ours[name], tallies)]


def _methods(start: Misfit, number: int) -> dict[str, Callable[[], np.ndarray]]:
    """Who searches from this start."""
    registry, first = load(), start.parameters(start.start())
    methods: dict[str, Callable[[], np.ndarray]] = {
        name: lambda name=name: searched(registry.identifier(name)(), start)  # type: ignore[misc]
        for name in ("multi_start", "sensitivity")
    }
    if number < PEER_STARTS:
        peers = (*PEERS, LMFIT) if LMFIT.is_installed else PEERS
        methods |= {peer.name: lambda peer=peer: peer.fit(start, first) for peer in peers}  # type: ignore[misc]
    if PEER_STARTS and number == 0 and len(first) == 4:
        methods[EVOLVED] = lambda: evolved(problem(TOYS[ONE]), 0)
    return methods


def _compared(case: str, name: str, ours: Tally, peers: dict[str, Tally]) -> list[Row]:
    rows = [Row(f"{case}: {name}, all to {EXACT:g} from {len(ours.errors)} starts", "rate", "1", ours.rate(EXACT), "", None)]
    for peer, theirs in peers.items():
        few = Tally(ours.errors[: len(theirs.errors)], ours.times[: len(theirs.times)])
        for limit in (EXACT, CLOSE):
            told = f"{case}: {name}, all to {limit:g} from {len(theirs.errors)} starts"
            rows.append(Row(told, "rate", "1", few.rate(limit), peer, theirs.rate(limit)))
        rows.append(Row(f"{case}: {name}, a search", "time", "s", median(few.times), peer, median(theirs.times)))
    if LMFIT.name not in peers:
        rows.append(Row(f"{case}: {name}, a search", "time", "s", median(ours.times), LMFIT.name, None))
    return rows
