"""One run: parameter values, initial state and columns of sensitivities, filled into the arrays of the kernel."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.mechanics.arrays import BODY, D_MAX, FUNCTION, JOINT, REST, STAGES, START, Floats, Record, Records, Work
from crashkit.mechanics.engine import Engine
from crashkit.mechanics.layout import Layout


def prepare(layout: Layout, values: Mapping[str, float], initial: xr.Dataset | None) -> Layout:
    """The layout of one run: the model's, then the recording's initial state, then the values given by path."""
    layout = evolve(
        layout,
        parameters=layout.parameters.copy(),
        masses=layout.masses.copy(),
        free_lengths=layout.free_lengths.copy(),
        position=_initial(layout, "position", initial),
        velocity=_initial(layout, "velocity", initial),
    )
    for path, value in values.items():
        if not path.startswith("instrument."):
            array, entries = _place(layout, path)
            array[list(entries)] = value
    return layout


def _initial(layout: Layout, name: str, initial: xr.Dataset | None) -> Floats:
    values: Floats = getattr(layout, name).copy()
    if initial is not None:
        index = {body: i for i, body in enumerate(layout.bodies)}
        for body, row in zip(initial["body"].values.tolist(), initial.variables[name].values, strict=True):
            if body in index:
                values[index[body]] = np.ravel(row)[0]
    return values


def _place(layout: Layout, path: str) -> tuple[Floats, tuple[int, ...]]:
    """The array that holds a parameter, and its entries there; raises CrashkitError for a path the model does not have."""
    if path in layout.slots:
        return layout.parameters, layout.slots[path]
    kind, _, rest = path.partition(".")
    name, _, quantity = rest.rpartition(".")
    arrays = {
        ("body", "mass"): layout.masses,
        ("body", "position"): layout.position,
        ("body", "velocity"): layout.velocity,
        ("joint", "free_length"): layout.free_lengths,
    }
    names = layout.bodies if kind == "body" else layout.joints
    if (kind, quantity) not in arrays or name not in names:
        raise CrashkitError(f"expected a parameter of the model, found {path}")
    return arrays[kind, quantity], (names.index(name),)


def work_of(layout: Layout, engine: Engine, paths: Sequence[str]) -> Work:
    """The arrays of a run at t = 0, its branches not yet chosen, with a column of derivatives for each of `paths`."""
    bodies, joints, functions = _bodies(layout), _joints(layout), _functions(layout, engine)
    shape = (STAGES, 3 * bodies.size)
    widest = max(functions["count"], default=0)
    work = Work(
        bodies=bodies,
        joints=joints,
        functions=functions,
        parameters=layout.parameters,
        state=np.zeros(shape),
        columns=np.full(layout.parameters.size, -1),
        tangent=np.zeros((*shape, len(paths))),
        joint_tangent=np.zeros((joints.size, 3, len(paths))),
        partials=np.zeros((functions.size, 3 + widest)),
    )
    work.state[START, : 2 * bodies.size] = *layout.position, *np.where(np.isinf(layout.masses), 0.0, layout.velocity)
    for column, path in enumerate(paths):
        _seed(layout, work, path, column)
    _set_memory(layout, work)
    return work


def record_of(work: Work, times: int) -> Record:
    """Room for the results."""
    _, entries, columns = work.tangent.shape
    rows = times if columns else 0
    return Record(
        state=np.empty((times, entries)),
        force=np.empty((times, work.joints.size)),
        tangent=np.empty((rows, entries, columns)),
        force_tangent=np.empty((rows, work.joints.size, columns)),
    )


def _bodies(layout: Layout) -> Records:
    bodies = np.zeros(len(layout.bodies), BODY)
    bodies["inverse_mass"] = 1.0 / layout.masses
    bodies["mass_column"] = -1
    return bodies


def _joints(layout: Layout) -> Records:
    joints = np.zeros(len(layout.joints), JOINT)
    first, second = layout.ends.T
    offset = layout.points[:, 1] - layout.points[:, 0]
    apart = layout.position[second] - layout.position[first]
    direction = np.where(apart + offset < 0.0, -1.0, 1.0)
    bounds = np.cumsum([0, *map(len, layout.functions)])
    joints["first"], joints["second"], joints["direction"] = first, second, direction
    joints["rest"] = np.where(np.isnan(layout.free_lengths), direction * apart, layout.free_lengths - direction * offset)
    joints["start"], joints["stop"] = bounds[:-1], bounds[1:]
    return joints


def _functions(layout: Layout, engine: Engine) -> Records:
    functions = np.zeros(layout.offsets.size - 1, FUNCTION)
    functions["number"] = [engine.numbers[function] for own in layout.functions for function in own]
    functions["offset"], functions["count"] = layout.offsets[:-1], np.diff(layout.offsets)
    return functions


def _seed(layout: Layout, work: Work, path: str, column: int) -> None:
    """Make a column the derivatives to one parameter."""
    array, entries = _place(layout, path)
    first = entries[0]
    if array is layout.parameters:
        work.columns[list(entries)] = column
    elif array is layout.masses:
        work.bodies["mass_column"][first] = column
    elif array is layout.free_lengths:
        work.joint_tangent[first, REST, column] = 1.0
    elif array is layout.velocity:
        work.tangent[START, work.bodies.size + first, column] = np.isfinite(layout.masses[first])
    else:
        work.tangent[START, first, column] = 1.0
        ends = (work.joints["second"] == first).astype(float) - (work.joints["first"] == first)
        work.joint_tangent[:, REST, column] = np.isnan(layout.free_lengths) * work.joints["direction"] * ends


def _set_memory(layout: Layout, work: Work) -> None:
    """A joint remembers the deformation that it begins with, if it is compressed."""
    joints, tangent = work.joints, work.tangent[START]
    apart = layout.position[joints["second"]] - layout.position[joints["first"]]
    deformation = joints["rest"] - joints["direction"] * apart
    joints["d_max"] = np.maximum(0.0, deformation)
    moved = joints["direction"][:, np.newaxis] * (tangent[joints["second"]] - tangent[joints["first"]])
    work.joint_tangent[:, D_MAX] = np.where(deformation[:, np.newaxis] > 0.0, work.joint_tangent[:, REST] - moved, 0.0)
