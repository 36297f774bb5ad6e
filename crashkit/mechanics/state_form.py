"""The state form: between two crossings of thresholds the accelerations are f(X) U + g(X), linear in the parameters U."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from crashkit.mechanics.engine import Engine
from crashkit.mechanics.joint_track import in_space, rotations, shared, tracks_of
from crashkit.mechanics.kernel.arrays import Integers
from crashkit.mechanics.motion import XYZ
from crashkit.model import Body, Model
from crashkit.protocols import Laws

NUDGE = 1.25
"""What a parameter is multiplied by to see whether the equations are linear in it."""
UNITS = {"acceleration": "m s-2", "angular_acceleration": "rad s-2"}
INERTIA = {1: ((0, 0),), 3: ((0, 0), (1, 1), (2, 2)), 6: ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))}
"""Which entries of the inertia matrix a body gives, by how many numbers it gives; in the plane that of the normal."""


def state_form(model: Model, laws: Laws, motion: xr.Dataset) -> xr.Dataset:
    """The equations of motion along a motion, as they depend on the model's free parameters.

    x'' = f(X) U + g(X) on each interval between two crossings (Mizzi & Jezequel 1992, eq 33). Where a parameter enters
    in another way (a threshold that multiplies a slope, a mass), f is the derivative, and `linear` says so.

    Arguments:
        model: in one, two or three axes; what its laws remember is nothing at the first instant of the motion.
        laws: installed laws and factors by name.
        motion: `position` and `velocity` (time, body, axis), m and m s-1, of all the bodies that joints hold, from t = 0; in
            several axes also `orientation` and `angular_velocity`, as `Simulator.run` gives them.

    Returns:
        Dataset with `matrix` f (time, body, axis, parameter), `given` g and `acceleration` f U + g (time, body, axis), m s-2,
        in several axes also `angular_matrix`, `angular_given` and `angular_acceleration`, rad s-2; 0 for bodies that no force
        moves. `linear` (parameter): whether the equations are linear in it and in all others that are. `branch` (time, joint):
        a number for each branch that a joint's law takes. `interval_number` (time), in the common sequence of the intervals of
        all joints; `start`, `end` (interval), s, the first and last instant of each; `crossing` (interval), the joints that
        begin it. A crossing, and the largest deformation, are known to the sampling of the motion.
    """
    equations = StateForm(model, laws, motion)
    values = model.values()
    modes = equations.modes(values)
    acceleration, matrix = equations.at(values, modes)
    given = acceleration - matrix @ np.array([values[path] for path in equations.paths])
    variables: dict[str, Any] = {"linear": ("parameter", equations.linear(values, modes))}
    count = motion.sizes["axis"]
    for start, name, prefix in ((0, "acceleration", ""), (count, "angular_acceleration", "angular_")):
        columns = slice(start, start + count)
        if start < acceleration.shape[2]:
            by_body = ("time", "body", "axis")
            variables[name] = (by_body, acceleration[:, :, columns], {"units": UNITS[name]})
            variables[f"{prefix}given"] = (by_body, given[:, :, columns], {"units": UNITS[name]})
            variables[f"{prefix}matrix"] = ((*by_body, "parameter"), matrix[:, :, columns])
    names = {"body": [body.name for body in model.bodies], "axis": motion["axis"].values, "parameter": list(equations.paths)}
    return xr.Dataset(variables, names).merge(_intervals(model, motion["time"].values, modes))


class StateForm:
    """The accelerations that a model gives its bodies along a motion, and their derivatives to its free parameters.

    Arguments:
        model, laws, motion: those of `state_form`; of several motions end to end, where time goes back the next begins.
        engine: one that holds the model's functions; None: one of its own.

    Attributes:
        paths: of the free parameters of bodies and joints.
        tracks: the joints along the motion.
    """

    def __init__(self, model: Model, laws: Laws, motion: xr.Dataset, engine: Engine | None = None) -> None:
        self.model, self.motion = model, motion
        self.paths = tuple(path for path in model.free_parameters() if not path.startswith("instrument."))
        self.tracks = tracks_of(model, laws, motion, engine)
        self._columns = [shared(track.paths, self.paths) for track in self.tracks]
        self._dof = 1 if len(model.axes) == 1 else 6
        self._loads = given_loads(model, motion, self._dof)

    def modes(self, values: Mapping[str, float]) -> list[Integers]:
        """The branches (function, time) that each joint takes."""
        return [track.modes(values) for track in self.tracks]

    def at(self, values: Mapping[str, float], modes: Sequence[Integers]) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations (time, body, axis), m s-2, on given branches, and their derivatives (..., parameter).

        In several axes the three of each body are followed by its angular accelerations, rad s-2.

        Arguments:
            values: of every parameter, by path.
            modes: of every joint, as `modes` gives them.
        """
        load, slopes = self._loads.copy(), np.zeros((*self._loads.shape, len(self.paths)))
        for track, taken, (own, columns) in zip(self.tracks, modes, self._columns, strict=True):
            push, table = track.push(taken, values)
            for row, along in track.ends:
                load[:, row] += push[:, None] * along
                slopes[:, row][..., columns] += table[:, None, own] * along[:, :, None]
        for row, body in enumerate(self.model.bodies):
            load[:, row], slopes[:, row] = self._response(row, body, load[:, row], slopes[:, row], values)
        return load, slopes

    def linear(self, values: Mapping[str, float], modes: Sequence[Integers]) -> np.ndarray:
        """Whether no derivative changes with a parameter while the branches are held, (parameter,)."""
        matrix = self.at(values, modes)[1]
        size = 1e-9 * np.abs(matrix).max(axis=(0, 1, 2), initial=0.0)
        nudges = [{**values, path: values[path] * NUDGE if values[path] else NUDGE} for path in self.paths]
        changes = [np.abs(self.at(nudge, modes)[1] - matrix).max(axis=(0, 1, 2), initial=0.0) for nudge in nudges]
        return np.array([bool(np.all(change <= size)) for change in changes], dtype=bool)

    def _response(
        self, row: int, body: Body, load: np.ndarray, slopes: np.ndarray, values: Mapping[str, float]
    ) -> tuple[np.ndarray, np.ndarray]:
        """The accelerations that a load (time, axis) gives a body, and their derivatives."""
        if not body.is_free:
            return np.zeros_like(load), np.zeros_like(slopes)
        mass, path = values[f"body.{body.name}.mass"], f"body.{body.name}.mass"
        straight = min(self._dof, 3)
        acceleration, derivative = load / mass, slopes / mass
        if path in self.paths:
            derivative[:, :, self.paths.index(path)] -= acceleration / mass
        if self.model.gravity:
            acceleration[:, :straight] += in_space(self.model.axes, self.model.gravity)
        if self._dof > 1:
            spin = _Spin(self.model, body, self.motion)
            acceleration[:, 3:], derivative[:, 3:] = spin.response(load[:, 3:], slopes[:, 3:], values, self.paths)
        return acceleration, derivative


class _Spin:
    """How a body turns: Euler's equations in its own frame, I w' = M - w x I w."""

    def __init__(self, model: Model, body: Body, motion: xr.Dataset) -> None:
        self._frame = rotations(motion, body.name)
        spin = motion["angular_velocity"].sel(body=body.name).transpose("time", "axis").values
        self._spin = self._frame.inv().apply(spin)
        prefix = f"body.{body.name}.inertia"
        count = len(body.inertia)
        self._paths = [prefix] if count == 1 else [f"{prefix}[{i}]" for i in range(count)]
        self._units = [_unit_inertia(model, entry) for entry in INERTIA[count]]

    def response(
        self, moment: np.ndarray, slopes: np.ndarray, values: Mapping[str, float], paths: Sequence[str]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Angular accelerations (time, axis) in the laboratory frame, and their derivatives (time, axis, parameter)."""
        inertia = sum(values[path] * unit for path, unit in zip(self._paths, self._units, strict=True))
        inverse = np.linalg.pinv(inertia)  # in the plane there is none about the axes in it
        own = self._frame.inv()
        acceleration = (own.apply(moment) - np.cross(self._spin, self._spin @ inertia)) @ inverse
        derivative = np.stack([own.apply(column) @ inverse for column in np.moveaxis(slopes, 2, 0)] or [acceleration[:0]], -1)
        for path, unit in zip(self._paths, self._units, strict=True):
            if path in paths:
                change = acceleration @ unit + np.cross(self._spin, self._spin @ unit)
                derivative[:, :, paths.index(path)] -= change @ inverse
        return self._frame.apply(acceleration), np.stack([self._frame.apply(c) for c in np.moveaxis(derivative, 2, 0)], -1)


def _unit_inertia(model: Model, entry: tuple[int, int]) -> np.ndarray:
    """The inertia matrix with 1 in one entry, which in the plane is about its normal."""
    matrix = np.zeros((3, 3))
    if len(model.axes) == 2:
        normal = next(row for row, axis in enumerate(XYZ) if axis not in model.axes)
        entry = (normal, normal)
    matrix[entry] = matrix[entry[::-1]] = 1.0
    return matrix


def given_loads(model: Model, motion: xr.Dataset, dof: int) -> np.ndarray:
    """The forces (N) and, where `dof` is 6, moments (N m) that a test puts on its bodies, (time, body, axis)."""
    times = motion["time"].values
    loads = np.zeros((len(times), len(model.bodies), dof))
    for row, body in enumerate(model.bodies):
        if body.force is None:
            continue
        parts = [np.array([in_space(model.axes, force) for force in body.force.force])]
        if body.force.moment:
            parts.append(np.array([_moment(model, moment) for moment in body.force.moment]))
        for number, table in enumerate(parts):
            for axis, column in enumerate(table.T):
                loads[:, row, 3 * number + axis] = np.interp(times, body.force.time, column, left=0.0)
        loads[times >= body.force.time[-1], row] = 0.0
    return loads


def _moment(model: Model, moment: Sequence[float]) -> np.ndarray:
    """A moment in space; in the plane it is about the normal, from the first axis to the second."""
    if len(model.axes) == 3:
        return np.array(moment, dtype=float)
    first, second = (in_space(model.axes, unit) for unit in ((1.0, 0.0), (0.0, 1.0)))
    return np.asarray(moment[0] * np.cross(first, second))


def _changed(modes: Sequence[Integers], count: int) -> np.ndarray:
    """Whether a joint takes other branches than at the instant before, (time, joint)."""
    changed = np.zeros((count, len(modes)), dtype=bool)
    for joint, taken in enumerate(modes):
        changed[1:, joint] = (np.diff(taken) != 0).any(axis=0)
    return changed


def _ends_of_intervals(changed: np.ndarray) -> list[int]:
    """The first and the last instant of each interval, in turn."""
    starts = np.flatnonzero(changed.any(axis=1)).tolist()
    return [row for pair in zip([0, *starts], [*(row - 1 for row in starts), len(changed) - 1], strict=True) for row in pair]


def _intervals(model: Model, times: np.ndarray, modes: Sequence[Integers]) -> xr.Dataset:
    """The branches as numbers, and the sequence of intervals that all joints share."""
    branch = np.array([_numbered(taken) for taken in modes], dtype=int).reshape(len(modes), len(times)).T
    changed = _changed(modes, len(times))
    ends = _ends_of_intervals(changed)
    names = np.array([joint.name for joint in model.joints], dtype=str)
    return xr.Dataset(
        {
            "branch": (("time", "joint"), branch),
            "interval_number": ("time", np.cumsum(changed.any(axis=1))),
            "start": ("interval", times[ends[::2]], {"units": "s"}),
            "end": ("interval", times[ends[1::2]], {"units": "s"}),
            "crossing": ("interval", [", ".join(names[changed[row]]) for row in ends[::2]]),
        },
        {"time": ("time", times, {"units": "s"}), "joint": names},
    )


def _numbered(taken: Integers) -> list[int]:
    """The branches of a joint as numbers, in the order in which they are first taken."""
    sequence = list(map(tuple, taken.T.tolist()))
    numbers = {branches: number for number, branches in enumerate(dict.fromkeys(sequence))}
    return [numbers[branches] for branches in sequence]
