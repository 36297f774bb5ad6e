"""One run: parameter values, initial state and columns of sensitivities, filled into the arrays of the kernel."""

from collections.abc import Collection, Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from attrs import evolve
from scipy.spatial.transform import Rotation

from crashkit.mechanics.engine import Engine
from crashkit.mechanics.kernel.arrays import (
    BODY,
    FORCES,
    FUNCTION,
    JOINT,
    NONE,
    REST,
    STAGES,
    START,
    Floats,
    Record,
    Records,
    Work,
)
from crashkit.mechanics.layout import DOF, Layout, memory_rate

ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Where xx, yy, zz, xy, xz and yz stand in the inertia."""


def prepare(layout: Layout, values: Mapping[str, float], initial: xr.Dataset | None) -> Layout:
    """The layout of one run: the model's, then the recording's initial state, then the values given by path."""
    start, quaternions = _initial(layout, initial)
    arrays: dict[str, Any] = {
        "parameters": layout.parameters.copy(),
        "masses": layout.masses.copy(),
        "inertia": layout.inertia.copy(),
        "points": layout.points.copy(),
        "free_lengths": layout.free_lengths.copy(),
        "start": start,
    }
    for path, value in values.items():
        if not path.startswith("instrument."):
            name, index = layout.place(path)
            arrays[name][index] = value
    return evolve(layout, quaternions=quaternions, **arrays)


def _initial(layout: Layout, initial: xr.Dataset | None) -> tuple[Floats, Floats]:
    start, quaternions = layout.start.copy(), layout.quaternions.copy()
    if initial is None:
        return start, quaternions
    index = {body: i for i, body in enumerate(layout.bodies)}
    known = initial.variables["body"].values.tolist()
    rows = [i for i, body in enumerate(known) if body in index]
    own = [index[known[i]] for i in rows]
    moving = [i for i, b in enumerate(own) if np.isfinite(layout.masses[b])]
    axes = len(layout.axes)
    letters = initial.variables["axis"].values.tolist()
    columns = [letters.index(axis) for axis in layout.axes]
    start[0, own, :axes] = initial.variables["position"].values[rows][:, columns]
    velocity = initial.variables["velocity"].values[rows][:, columns]
    start[1, [own[i] for i in moving], :axes] = velocity[moving]
    if axes > 1:
        _initial_rotation(layout, initial, rows, own, start, quaternions)
    return start, quaternions


def _initial_rotation(
    layout: Layout, initial: xr.Dataset, rows: list[int], own: list[int], start: Floats, quaternions: Floats
) -> None:
    axes = len(layout.axes)
    if "orientation" in initial:
        orientation = initial.variables["orientation"].values[rows]
        if axes == 3:
            quaternions[own] = orientation
        else:
            start[0, own, 2] = Rotation.from_quat(orientation, scalar_first=True).as_rotvec() @ normal_of(layout.axes)
    if "angular_velocity" in initial:
        rates = initial.variables["angular_velocity"].values[rows]
        start[1, own, axes:] = rates if axes == 3 else (rates @ normal_of(layout.axes))[:, None]


@cache
def normal_of(axes: tuple[str, ...]) -> Floats:
    """The axis about which angles of a plane are positive: its first axis turns to its second."""
    first, second = (np.eye(3)["xyz".index(axis)] for axis in axes)
    return np.cross(first, second)


def work_of(layout: Layout, engine: Engine, paths: Sequence[str]) -> Work:
    """The arrays of a run at t = 0, its branches not yet chosen, with a column of derivatives for each of `paths`."""
    dof = DOF[len(layout.axes)]
    n, columns = dof * len(layout.bodies), len(paths)
    functions = _functions(layout, engine, 2 * n)
    size = 2 * n + int(np.count_nonzero(functions["memory"] >= 0))
    widest = max(functions["count"], default=0)
    work = Work(
        bodies=bodies_of(layout),
        joints=joints_of(layout),
        functions=functions,
        parameters=layout.parameters,
        given=layout.given,
        state=np.zeros((STAGES, 2 * size)),
        columns=np.full(layout.parameters.size, -1),
        partials=np.zeros((functions.size, 4 + widest)),
        tangent=np.zeros((STAGES, 2 * size, columns)),
        joint_tangent=np.zeros((len(layout.joints), FORCES + STAGES, columns)),
        net_tangent=np.zeros((STAGES, n if columns else 0, columns)),
    )
    work.state[START, : 2 * n] = layout.start.ravel()
    for column, path in enumerate(paths):
        _seed(layout, work, path, column)
    return work


def record_of(work: Work, axes: int, times: int, wanted: Collection[int] | None = None) -> Record:
    """Room for the results: for these entries, by default for all."""
    _, entries, columns = work.tangent.shape
    entries += 3 * work.joints.size + DOF[axes] * work.bodies.size
    turns = 4 * work.bodies.size if axes == 3 else 0
    asked = np.arange(entries + turns) if wanted is None else np.array(sorted(wanted), dtype=int)
    slots = np.full(entries + turns, NONE)
    slots[asked] = np.arange(asked.size)
    tangents = np.empty((times if columns else 0, np.count_nonzero(asked < entries), columns))
    return Record(np.empty((times, asked.size)), tangents, slots)


def bodies_of(layout: Layout) -> Records:
    """The bodies' records; the arrays of the layout may have first dims of their own, of many runs."""
    bodies = np.zeros(layout.masses.shape, BODY)
    bodies["inverse_mass"] = 1.0 / layout.masses
    bodies["mass_column"] = -1
    bodies["inertia_columns"] = -1
    bodies["frame"][..., 9:] = layout.quaternions
    inertia, turning = bodies["inertia"], np.any(layout.inertia > 0.0, axis=-1)
    for entry, (i, k) in enumerate(ENTRIES):
        inertia[..., 0, i, k] = inertia[..., 0, k, i] = layout.inertia[..., entry]
    if len(layout.axes) == 2:
        inertia[turning, 1, 2, 2] = 1.0 / inertia[turning, 0, 2, 2]
    if len(layout.axes) == 3:
        inertia[turning, 1] = np.linalg.inv(inertia[turning, 0])
    return bodies


def joints_of(layout: Layout) -> Records:
    """The joints' records, likewise."""
    joints = np.zeros(layout.free_lengths.shape, JOINT)
    axes = len(layout.axes)
    bounds = np.cumsum([0, *map(len, layout.functions)])
    joints["first"], joints["second"] = layout.ends.T
    joints["pushed_first"], joints["pushed_second"] = layout.pushed.T
    for end in range(2):
        joints["places"][..., 3 * end : 3 * end + axes] = layout.points[..., end, :]
    joints["places"][..., 6 : 6 + axes] = layout.normals
    joints["face"] = np.isfinite(layout.normals[:, 0])
    if axes == 1:
        ends = layout.start[..., 0, layout.ends, 0] + layout.points[..., 0]
        joints["places"][..., 6] = np.where(ends[..., 1] < ends[..., 0], -1.0, 1.0)
    joints["point_columns"] = -1
    joints["moves_points"] = 0
    joints["rest"] = layout.free_lengths
    joints["start"], joints["stop"] = bounds[:-1], bounds[1:]
    return joints


def _functions(layout: Layout, engine: Engine, memories: int) -> Records:
    functions = np.zeros(layout.offsets.size - 1, FUNCTION)
    own = [function for joint in layout.functions for function in joint]
    functions["code"] = [engine.codes[function] for function in own]
    functions["offset"], functions["count"] = layout.offsets[:-1], np.diff(layout.offsets)
    functions["driver"] = layout.drivers
    functions["memory"] = -1
    for f, function in enumerate(own):
        if function.law.memory:
            functions["memory"][f] = memories
            functions["memory_code"][f] = engine.codes[memory_rate(function)]
            memories += 1
    return functions


def _seed(layout: Layout, work: Work, path: str, column: int) -> None:
    """Make a column the derivatives to one parameter."""
    name, index = layout.place(path)
    _, bodies, dof = layout.start.shape
    match name, index:
        case "parameters", (entries,):
            work.columns[list(entries)] = column
        case "masses", (body,):
            work.bodies["mass_column"][body] = column
        case "inertia", (body, entry):
            work.bodies["inertia_columns"][body, entry] = column
        case "free_lengths", (joint,):
            work.joint_tangent[joint, REST, column] = 1.0
        case "points", (joint, end, axis):
            work.joints["point_columns"][joint, len(layout.axes) * end + axis] = column
            work.joints["moves_points"][joint] = 1
        case _, (row, body, k):
            work.tangent[START, dof * (bodies * row + body) + k, column] = row == 0 or np.isfinite(layout.masses[body])
