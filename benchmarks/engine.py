"""One simulation: ours with plugin laws, beside a reference in C and general solvers.

The reference (benchmarks/reference) knows one law and one model at compile time; its plain form steps over the corners of the
law, its event-located form lands on them as crashkit does. Errors are distances, at the end, from the reference at a 32nd of
the step. exudyn and MuJoCo (`pip install exudyn mujoco`) and scipy get the law as Python and run once.
"""

import numpy as np

from benchmarks import Row, seconds
from benchmarks._mechanics.models import LAWS, Case, cases
from benchmarks._mechanics.peers import Solver, peers
from benchmarks._mechanics.reference import Reference, compiler
from benchmarks._mechanics.timing import fastest
from crashkit.mechanics import Simulator

EVENTS, PLAIN = "C, event-located", "C, plain"
AGREEMENT = 1e-9
"""m, between ours and the reference at every time."""
FINER = 32


def run() -> list[Row]:
    """Time and error of each model."""
    return [row for case in cases() for row in _rows(case)]


def _rows(case: Case) -> list[Row]:
    simulator = Simulator(case.model, LAWS)
    position = positions(simulator.run(case.times, step=case.step), case)
    if compiler() is None:
        spent = fastest({"ours": lambda: simulator.record(case.times, step=case.step)})["ours"]
        return [Row(case.name, "time", "ms", 1e3 * spent, peer, None) for peer in (EVENTS, PLAIN)] if spent else []
    reference = Reference(case.model)
    theirs = {EVENTS: _position(reference, case), PLAIN: _position(reference, case, plain=True)}
    check(case, position, theirs[EVENTS])
    truth = reference.run(case.times[-1:], case.step / FINER)[0].position[-1]
    rows = [*_times(case, simulator, reference), *_errors(case, position, theirs, truth)]
    for peer, solver in peers(case).items():
        rows += _peer(case, rows[0].ours, float(np.abs(position[-1] - truth).max()), peer, solver, truth)
    return rows


def positions(motion, case: Case) -> np.ndarray:  # type: ignore[no-untyped-def]
    """(time, coordinate) of the bodies that move, in plane motion with their angles, as the reference has them."""
    names = [body.name for body in case.model.bodies if not body.fixed]
    along = motion["position"].sel(body=names).transpose("time", "body", "axis").values
    if len(case.model.axes) == 1:
        return along[..., 0]
    w, _, _, z = motion["orientation"].sel(body=names).transpose("quaternion", "time", "body").values
    return np.concatenate([along[..., :2], 2.0 * np.arctan2(z, w)[..., None]], axis=2).reshape(len(along), -1)


def check(case: Case, ours: np.ndarray, theirs: np.ndarray) -> None:
    """Raise where ours and the reference do not agree."""
    apart = float(np.abs(ours - theirs).max())
    if not apart < AGREEMENT:
        raise RuntimeError(f"{case.name}: expected ours and the reference to agree within {AGREEMENT} m, found {apart:.2e} m")


def _position(reference: Reference, case: Case, plain: bool = False) -> np.ndarray:
    return reference.run(case.times, case.step, plain)[0].position


def _times(case: Case, simulator: Simulator, reference: Reference) -> list[Row]:
    """All of them record every step."""
    room = reference.room(case.times.size)
    spent = fastest(
        {
            "arrays": lambda: simulator.record(case.times, step=case.step),
            "Dataset": lambda: simulator.run(case.times, step=case.step),
            EVENTS: lambda: reference.call(case.times, case.step, False, *room),
            PLAIN: lambda: reference.call(case.times, case.step, True, *room),
        }
    )
    pairs = (("arrays", EVENTS), ("arrays", PLAIN), ("Dataset", EVENTS))
    steps = case.times.size - 1
    return [Row(f"{case.name}, {steps} steps, {ours}", "time", "ms", *_ms(spent, ours, peer)) for ours, peer in pairs]


def _ms(spent, ours: str, peer: str) -> tuple[float, str, float]:  # type: ignore[no-untyped-def]
    return 1e3 * spent[ours], peer, 1e3 * spent[peer]


def _errors(case: Case, ours: np.ndarray, theirs: dict[str, np.ndarray], truth: np.ndarray) -> list[Row]:
    own = float(np.abs(ours[-1] - truth).max())
    return [
        Row(f"{case.name}, position at the end", "error", "m", own, peer, float(np.abs(found[-1] - truth).max()))
        for peer, found in theirs.items()
    ]


def _peer(case: Case, ours: float, error: float, peer: str, solver: Solver | None, truth: np.ndarray) -> list[Row]:
    found: list[np.ndarray] = []
    spent = 1e3 * seconds(lambda: found.append(solver())) if solver else None
    missed = float(np.abs(found[0] - truth).max()) if found else None
    return [
        Row(f"{case.name}, arrays", "time", "ms", ours, peer, spent),
        Row(f"{case.name}, position at the end", "error", "m", error, peer, missed),
    ]
