"""Many runs of one model, on all cores, without Python in the loop."""

import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import xarray as xr
from attrs import evolve
from numpy.typing import ArrayLike

from crashkit.errors import CrashkitError
from crashkit.mechanics.checks import check_step, checked_times
from crashkit.mechanics.kernel.arrays import Floats
from crashkit.mechanics.kernel.run import DONE
from crashkit.mechanics.layout import DOF, Layout
from crashkit.mechanics.motion import UNITS, dims_of, recorded
from crashkit.mechanics.run import bodies_of, joints_of, prepare, record_of, work_of
from crashkit.mechanics.simulator import NO_HISTORY, Simulator, with_knots

BATCH = 64_000_000
"""Bytes of records that are held at a time."""
ARRAYS = ("parameters", "masses", "inertia", "points", "free_lengths", "start")
"""Of a layout, that values may change."""


def simulate_many(
    simulator: Simulator,
    times: ArrayLike,
    values: Mapping[str, ArrayLike],
    initial: xr.Dataset | None = None,
    quantities: Sequence[str] = ("position", "velocity", "force"),
    step: float = 1e-4,
    workers: int | None = None,
) -> xr.Dataset:
    """The motions of one model at many values.

    Arguments:
        simulator: of the model.
        times: s, as `Simulator.run` takes them.
        values: by path, one number for each run; numbers that all runs share may be given alone.
        initial, step: as `Simulator.run` takes them.
        quantities: of the motion to keep.
        workers: threads; None: one for each core.

    Returns:
        The quantities with a first dim `run`, and `status(run)`, a sentence. A run that failed is NaN throughout.

    Raises:
        CrashkitError: numbers of runs that differ, a path or quantity that is not there, a value that the model's file could
            not hold, times or a step that cannot be used.
    """
    instants, step = checked_times(times), check_step(step)
    columns = {path: np.atleast_1d(np.asarray(column, float)) for path, column in values.items()}
    lengths = {column.size for column in columns.values() if column.size > 1}
    if len(lengths) > 1 or any(column.ndim > 1 or not column.size for column in columns.values()):
        found = sorted(lengths) if lengths else 0
        raise CrashkitError(f"expected one number for each run at every path, found {found} numbers")
    finite = {path: column[np.isfinite(column)] for path, column in columns.items()}  # a run that is not fails alone
    for extreme in (np.min, np.max):
        simulator.allowed.check({path: float(extreme(column)) for path, column in finite.items() if column.size})
    runs = lengths.pop() if lengths else 1
    unknown = set(quantities) - UNITS.keys()
    if unknown:
        raise CrashkitError(f"expected quantities of a motion ({', '.join(UNITS)}), found {', '.join(sorted(unknown))}")
    size = max(1, BATCH // (8 * instants.size * _width(simulator)))
    parts = []
    for first in range(0, runs, size):
        share = {path: column[first : first + size] if column.size > 1 else column for path, column in columns.items()}
        parts.append(_batch(simulator, instants, share, min(size, runs - first), initial, quantities, step, workers))
    return xr.concat(parts, "run") if len(parts) > 1 else parts[0]


def _width(simulator: Simulator) -> int:
    """Numbers that a run leaves behind at each time."""
    work = work_of(simulator.layout, simulator.engine, ())
    return record_of(work, len(simulator.model.axes), 1).values.size


def _batch(
    simulator: Simulator,
    times: Floats,
    values: Mapping[str, Floats],
    runs: int,
    initial: xr.Dataset | None,
    quantities: Sequence[str],
    step: float,
    workers: int | None,
) -> xr.Dataset:
    axes, names = simulator.model.axes, simulator.names
    layout = _many(prepare(simulator.layout, {}, initial), values, runs)
    instants = with_knots(times, layout)
    records, ends = _integrate(simulator, layout, instants, runs, step, workers or os.cpu_count() or 1)
    records = records[:, np.searchsorted(instants, times)]
    records[ends[:, 0] != DONE] = np.nan
    arrays = recorded(records.reshape(runs * times.size, -1), axes, names["joint"].size, names["body"].size)
    variables = {
        name: xr.Variable(
            ("run", "time", *dims_of(name)),
            arrays[name].reshape(runs, times.size, *arrays[name].shape[1:]),
            {"units": UNITS[name]},
        )
        for name in quantities
        if name in arrays
    }
    sentences = [simulator.sentence(int(status), int(joint), t) for status, joint, t in ends]
    variables["status"] = xr.Variable("run", np.array(sentences, dtype=str))
    return xr.Dataset(variables, names).assign_coords(time=("time", times, {"units": "s"}))


def _many(layout: Layout, values: Mapping[str, Floats], runs: int) -> Layout:
    """A layout whose arrays have a first dim of runs."""
    arrays: dict[str, Any] = {name: np.repeat(getattr(layout, name)[None], runs, axis=0) for name in ARRAYS}
    for path, column in values.items():
        name, index = layout.place(path)
        arrays[name][:, *index] = column[:, None] if name == "parameters" else column
    return evolve(layout, **arrays)


def _integrate(
    simulator: Simulator, layout: Layout, times: Floats, runs: int, step: float, workers: int
) -> tuple[Floats, Floats]:
    """Records (run, time, entry), and how each run ended."""
    one: dict[str, Any] = {name: getattr(layout, name)[0] for name in ARRAYS}
    base = evolve(layout, **one)
    bodies, joints = bodies_of(layout), joints_of(layout)
    n = DOF[len(layout.axes)] * len(layout.bodies)
    first = work_of(base, simulator.engine, ())
    starts = np.zeros((runs, first.state.shape[1]))
    starts[:, : 2 * n] = layout.start.reshape(runs, 2 * n)
    empty = record_of(first, len(layout.axes), times.size)
    records, ends = np.empty((runs, *empty.values.shape)), np.empty((runs, 3))

    def share(part: slice) -> None:
        """Each thread has copies of its own: threads that count references to the same arrays wait for each other."""
        work = work_of(base, simulator.engine, ())
        own = records[part].copy(), ends[part].copy()
        simulator.engine.module.integrate_many(
            times.copy(), times.copy(), step, bodies[part].copy(), joints[part].copy(), work.functions,
            layout.parameters[part].copy(), work.given.copy(), starts[part].copy(), work.state, work.columns, work.partials,
            work.tangent, work.joint_tangent, work.net_tangent, own[0], empty.tangents.copy(), empty.slots.copy(),
            NO_HISTORY.copy(), own[1],
        )  # fmt: skip
        records[part], ends[part] = own

    bounds = np.linspace(0, runs, min(workers, runs) + 1).astype(int)
    parts = [slice(a, b) for a, b in zip(bounds[:-1], bounds[1:], strict=True)]
    if len(parts) == 1:
        share(parts[0])
        return records, ends
    share(slice(0, 0))  # compiled or loaded once, before the threads
    with ThreadPoolExecutor(len(parts)) as pool:
        list(pool.map(share, parts))
    return records, ends
