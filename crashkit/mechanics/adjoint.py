"""Back through a run: from weights of what it recorded to the gradient of their sum."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from crashkit.errors import CrashkitError
from crashkit.mechanics.engine import Engine
from crashkit.mechanics.kernel.arrays import Floats, Integers, Work
from crashkit.mechanics.layout import DOF, Layout
from crashkit.mechanics.motion import BY_BODY, BY_JOINT, XYZ
from crashkit.mechanics.run import normal_of


def history_of(work: Work, axes: int, steps: int) -> Floats:
    """Room for what the kernel remembers of each step."""
    size, turns = work.state.shape[1] // 2, 4 * work.bodies.size if axes == 3 else 0
    return np.empty((steps, size + 4 + 2 * work.joints.size + 2 * work.functions.size + turns))


def sweep_back(
    layout: Layout,
    work: Work,
    engine: Engine,
    history: Floats,
    steps: int,
    rows: Integers,
    seeds: Floats,
    parameters: Sequence[str],
) -> Floats:
    """The gradient to some parameters.

    Arguments:
        layout, work: of the run.
        engine: that ran it.
        history: of the run, `steps` of its rows.
        rows: of the run's record that the seeds are for.
        seeds: (time, entry) weights of the record's entries, all but memories and quaternions.
        parameters: their paths.
    """
    size, joints, axes = work.state.shape[1] // 2, work.joints.size, len(layout.axes)
    n = DOF[axes] * work.bodies.size
    of_state, own = np.zeros((max(rows) + 1, 2 * size)), np.zeros((max(rows) + 1, seeds.shape[1] - 4 * n))
    of_state[rows, : 2 * n], of_state[rows, size : size + 2 * n] = seeds[:, : 2 * n], seeds[:, 2 * n : 4 * n]
    own[rows] = seeds[:, 4 * n :]
    start, rooms = np.zeros(size), (np.zeros(size), np.zeros(n), np.zeros(own.shape[1]), np.zeros((4, size)))
    gradients = np.zeros(layout.parameters.size), np.zeros((joints, 2 + 2 * axes)), np.zeros((work.bodies.size, 7))
    free = np.isnan(layout.free_lengths)
    arrays = work.bodies, work.joints, work.functions, work.parameters, work.given, work.state, work.partials
    engine.module.sweep(history, steps, *arrays, of_state, own, free, *rooms, start, *gradients)
    return np.array([_to_parameter(layout, path, start, *gradients) for path in parameters])


def _to_parameter(layout: Layout, path: str, start: Floats, to_laws: Floats, to_joints: Floats, to_bodies: Floats) -> float:
    name, index = layout.place(path)
    _, bodies, dof = layout.start.shape
    match name, index:
        case "parameters", (entries,):
            return float(to_laws[list(entries)].sum())
        case "masses", (body,):
            return float(to_bodies[body, 6])
        case "inertia", (body, entry):
            return float(to_bodies[body, entry])
        case "free_lengths", (joint,):
            return float(to_joints[joint, 1])
        case "points", (joint, end, axis):
            return float(to_joints[joint, 2 + len(layout.axes) * end + axis])
    row, body, k = index
    moved = row == 0 or bool(np.isfinite(layout.masses[body]))
    return float(start[dof * (bodies * row + body) + k]) if moved else 0.0


def seeds_of(weights: xr.Dataset, times: Floats, axes: tuple[str, ...], names: xr.Coordinates) -> Floats:
    """Weights of a motion's quantities as those of a record's entries (time, entry), without memories.

    Raises:
        CrashkitError: a quantity that a motion does not have.
    """
    bodies, joints, dof = names["body"].size, names["joint"].size, DOF[len(axes)]
    parts = np.zeros((5, len(times), bodies, dof))
    by_joint = np.zeros((len(times), joints, 3))
    order = {"force": 0, "deformation": 1, "deformation_rate": 2}
    rows = {name: row for row, pair in zip((0, 1, 3, 4), BY_BODY, strict=True) for name in pair}
    turning = {pair[1] for pair in BY_BODY}
    for name, values in weights.items():
        if name in BY_JOINT:
            by_joint[:, :, order[str(name)]] += values.transpose("time", "joint").values
        elif name in rows and not (name in turning and len(axes) == 1):
            vector = values.transpose("time", "body", "axis").values
            parts[rows[name]] += _along(vector, axes, str(name) in turning)
        else:
            expected = ", ".join([*BY_JOINT, *rows])
            raise CrashkitError(f"expected weights of {expected}, found {name}")
    n = bodies * dof
    flat = parts.reshape(5, len(times), n)
    return np.concatenate([*flat[:4], by_joint.reshape(len(times), -1), flat[4]], axis=1)


def _along(vector: Floats, axes: tuple[str, ...], turning: bool) -> Floats:
    """Weights of a vector's components as those of the velocities of the kernel."""
    count, dof = len(axes), DOF[len(axes)]
    out = np.zeros((*vector.shape[:2], dof))
    if count == 2 and turning:
        out[:, :, 2] = vector @ normal_of(axes)
    elif turning:
        out[:, :, count:] = vector
    else:
        out[:, :, :count] = vector if count != 2 else vector[:, :, [XYZ.index(axis) for axis in axes]]
    return out
