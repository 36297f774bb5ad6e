"""Ten-parameter gradients: their cost in simulations, and their error, of ours, of the reference in C, and of differences.

The truth is the reference in extended precision at an eighth of the step, differentiated by differences. An
error is the largest over parameters, each relative to the largest derivative to it. The adjoint is that of the sum of all
positions, to the ten parameters and to all of the model.
"""

import numpy as np
import xarray as xr

from benchmarks import Row
from benchmarks._mechanics.models import LAWS, Case, cases
from benchmarks._mechanics.reference import Reference, compiler
from benchmarks._mechanics.timing import fastest
from benchmarks._mechanics.truth import Truth, differences, worst
from crashkit.mechanics import Simulator
from crashkit.mechanics.adjoint import seeds_of

EVERY = 20
"""Steps between the times at which errors are taken."""
PEER = "C, event-located"


def run() -> list[Row]:
    """Cost and error of each model."""
    chosen = [case for case in cases() if "orthogonal" not in case.name]
    return [row for case in chosen for row in (*_costs(case), *(_errors(case) if compiler() else []))]


def _costs(case: Case) -> list[Row]:
    simulator, times, step = Simulator(case.model, LAWS), case.times, case.step
    seeds = _seeds(simulator, case)
    everything = [path for path in simulator.model.free_parameters() if not path.endswith("]")]
    calls = {
        "run": lambda: simulator.record(times, step=step),
        "gradient": lambda: simulator.record(times, sensitivities=case.paths, step=step),
        "adjoint": lambda: simulator.gradient(times, seeds, case.paths, step=step),
        "everything": lambda: simulator.gradient(times, seeds, everything, step=step),
        **(_reference_calls(case) if compiler() else {"C run": None, "C gradient": None}),
    }
    spent = fastest(calls)
    of = f"{case.name}, {len(case.paths)} parameters"
    base, gradient = spent["run"], spent["gradient"]
    peer = (spent["C run"], spent["C gradient"])
    theirs = peer[1] / peer[0] if peer[0] and peer[1] else None
    return [
        Row(of, "time", "simulations", gradient / base, PEER, theirs),
        Row(of, "time", "ms", 1e3 * gradient, PEER, 1e3 * peer[1] if peer[1] else None),
        Row(f"{of}, adjoint", "time", "simulations", spent["adjoint"] / base, "", None),
        Row(
            f"{case.name}, {len(everything)} parameters, adjoint", "time", "simulations", spent["everything"] / base, "", None
        ),
    ]


def _reference_calls(case: Case):  # type: ignore[no-untyped-def]
    alone, whole = Reference(case.model), Reference(case.model, case.paths)
    room, more = alone.room(case.times.size), whole.room(case.times.size)
    return {
        "C run": lambda: alone.call(case.times, case.step, False, *room),
        "C gradient": lambda: whole.call(case.times, case.step, False, *more),
    }


def _seeds(simulator: Simulator, case: Case) -> np.ndarray:
    motion = simulator.run(case.times, step=case.step)
    return seeds_of(xr.ones_like(motion[["position"]]), case.times, case.model.axes, simulator.names)


def _errors(case: Case) -> list[Row]:
    """Of positions and of their derivatives, at the step of the case and at a quarter of it."""
    times = case.times[EVERY::EVERY]
    truth, rows = Truth(case, times), []
    reference = Reference(case.model, case.paths)
    expected = _along(truth.derivatives, reference)
    values = np.array([reference.value(path) for path in case.paths])
    for share in (1, 4):
        step = case.step / share
        motion = Simulator(case.model, LAWS).run(times, sensitivities=case.paths, step=step)
        theirs = reference.run(times, step)
        names = [body.name for body in reference.bodies[: reference.moving]]
        axes = list(case.model.axes)
        position, slopes = (motion[name].sel(body=names, axis=axes).values for name in ("position", "position_sensitivity"))
        size = np.abs(truth.position).max()
        errors = [
            float(np.abs(found - _along(truth.position, reference)).max() / size)
            for found in (position.reshape(times.size, -1), _along(theirs[0].position, reference))
        ]
        of = f"{case.name}, step {1e3 * step:g} ms"
        rows += [
            Row(f"{of}: positions", "error", "1", errors[0], PEER, errors[1]),
            Row(f"{of}: gradient", "error", "1", worst(slopes.reshape(expected.shape), expected, values), PEER,
                worst(_along(theirs[1].position, reference), expected, values)),
        ]  # fmt: skip
    plain = worst(_along(differences(Reference(case.model), case, times), reference), expected, values)
    return [*rows, Row(rows[1].case, "error", "1", rows[1].ours, "C, plain, differences", plain)]


def _along(values: np.ndarray, reference: Reference) -> np.ndarray:
    """Translations alone (time, coordinate, ...), without the angles of plane motion."""
    kept = [i for i in range(values.shape[1]) if i % reference.dof < 2]
    return values[:, kept]
