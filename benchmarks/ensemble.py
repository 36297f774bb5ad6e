"""Many simulations of one model on all cores: `simulate_many`, beside the reference in C in a loop on as many threads.

Every run has its own crush force and mass, and its state at the end is kept; those of ours and of the reference are compared.
"""

import os
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter

import numpy as np

from benchmarks import Row
from benchmarks._mechanics.models import LAWS, Case, cases
from benchmarks._mechanics.reference import Floats, Reference, compiler
from benchmarks._mechanics.timing import fastest
from crashkit.mechanics import Simulator, simulate_many

RUNS = {"two degrees": 10_000, "three-body car": 1_000, "figure 3, oblique": 200}
"""Fewer of the larger models, which would take minutes at the same rate."""
WORKERS = os.cpu_count() or 1
AGREEMENT = 1e-8
"""m, between the ends of ours and of the reference."""


def run() -> list[Row]:
    """Simulations each second."""
    return [row for case in cases() if case.name in RUNS for row in _rows(case, RUNS[case.name])]


def _rows(case: Case, runs: int) -> list[Row]:
    simulator, end = Simulator(case.model, LAWS), case.times[-1:]
    values = _values(case, runs)

    def ours(workers: int = WORKERS) -> Floats:
        many = simulate_many(simulator, end, values, quantities=["position"], step=case.step, workers=workers)
        return many["position"].values[:, 0]

    calls = {"ours": ours, "one": lambda: ours(1), **_reference(case, values)}
    if theirs := calls["C"]:
        _check(case, ours(), theirs())
    spent = fastest(calls, budget=0.0, rounds=2, clock=perf_counter)
    of, rate = f"{case.name}, {runs} runs", {name: runs / time if time else None for name, time in spent.items()}
    return [
        Row(f"{of}, {WORKERS} threads", "rate", "1/s", rate["ours"], "C, event-located", rate["C"]),
        Row(f"{of}, {WORKERS} threads", "rate", "1/s", rate["ours"], "ours, 1 thread", rate["one"]),
    ]


def _values(case: Case, runs: int) -> dict[str, Floats]:
    """Of the parameters to which gradients are taken, the first crush force and the last mass, by up to a tenth."""
    random, values = np.random.default_rng(0), case.model.parameters()
    force = next(path for path in case.paths if path.endswith("crush_force"))
    mass = [path for path in case.paths if path.endswith("mass")][-1]
    return {path: values[path].value * random.uniform(0.9, 1.1, runs) for path in (force, mass)}


def _reference(case: Case, values: dict[str, Floats]):  # type: ignore[no-untyped-def]
    if compiler() is None:
        return {"C": None}
    reference = Reference(case.model)
    inputs = reference.inputs(values)
    width = reference.room(1)[0].size
    found = np.empty((inputs.size, width))
    bounds = np.linspace(0, inputs.size, WORKERS + 1).astype(int)

    def share(first: int, last: int) -> None:
        reference.call_many(inputs[first:last], case.end, case.step, False, found[first:last])

    def call() -> Floats:
        with ThreadPoolExecutor(WORKERS) as pool:
            list(pool.map(share, bounds[:-1], bounds[1:]))
        return found[:, : reference.moving * reference.dof]

    return {"C": call}


def _check(case: Case, ours: Floats, theirs: Floats) -> None:
    """Raise where the translations at the ends do not agree."""
    moving = [i for i, body in enumerate(case.model.bodies) if not body.fixed]
    axes = len(case.model.axes)
    expected = theirs.reshape(len(theirs), len(moving), -1)[..., :axes]
    apart = float(np.abs(ours[:, moving, :axes] - expected).max())
    if not apart < AGREEMENT:
        raise RuntimeError(f"{case.name}: expected ends that agree within {AGREEMENT} m, found {apart:.2e} m apart")
