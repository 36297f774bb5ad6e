"""One run: parameter values, initial state and columns of sensitivities, filled into the arrays of the kernel."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.errors import CrashkitError
from crashkit.mechanics.arrays import STAGES, Floats, Record, State, Structure, Tangent
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


def structure_of(layout: Layout, engine: Engine) -> Structure:
    """The bodies and joints of a run."""
    position, (first, second) = layout.position, layout.ends.T
    apart = position[second] + layout.points[:, 1] - position[first] - layout.points[:, 0]
    direction = np.where(apart < 0.0, -1.0, 1.0)
    given = layout.free_lengths - direction * (layout.points[:, 1] - layout.points[:, 0])
    start = np.cumsum([0, *map(len, layout.functions)])
    numbers = [engine.numbers[function] for own in layout.functions for function in own]
    return Structure(
        inverse_mass=1.0 / layout.masses,
        first=np.ascontiguousarray(first),
        second=np.ascontiguousarray(second),
        direction=direction,
        rest=np.where(np.isnan(given), direction * (position[second] - position[first]), given),
        start=start,
        function=np.array(numbers, int),
        offset=layout.offsets,
        parameters=layout.parameters,
    )


def state_of(layout: Layout) -> State:
    """The state at t = 0, its branches not yet chosen."""
    shape = (STAGES, len(layout.bodies))
    joints = len(layout.joints)
    state = State(
        position=np.zeros(shape),
        velocity=np.zeros(shape),
        acceleration=np.zeros(shape),
        force=np.zeros(joints),
        d_max=np.zeros(joints),
        loading=np.zeros(joints, int),
        mode=np.zeros(sum(map(len, layout.functions)), int),
    )
    state.position[0] = layout.position
    state.velocity[0] = np.where(np.isinf(layout.masses), 0.0, layout.velocity)
    return state


def tangent_of(layout: Layout, structure: Structure, paths: Sequence[str]) -> Tangent:
    """The derivatives at t = 0 to the parameters of `paths`."""
    bodies, joints, columns = len(layout.bodies), len(layout.joints), len(paths)
    widest = max((function.count() for own in layout.functions for function in own), default=0)
    most = max(map(len, layout.functions), default=0)
    tangent = Tangent(
        position=np.zeros((STAGES, bodies, columns)),
        velocity=np.zeros((STAGES, bodies, columns)),
        acceleration=np.zeros((STAGES, bodies, columns)),
        force=np.zeros((joints, columns)),
        deformation=np.zeros((joints, columns)),
        d_max=np.zeros((joints, columns)),
        rest=np.zeros((joints, columns)),
        mass_column=np.full(bodies, -1),
        parameter_column=np.full(layout.parameters.size, -1),
        values=np.zeros(most),
        partials=np.zeros((most, 3 + widest)),
    )
    for column, path in enumerate(paths):
        _seed(layout, structure, tangent, path, column)
    return tangent


def _seed(layout: Layout, structure: Structure, tangent: Tangent, path: str, column: int) -> None:
    array, entries = _place(layout, path)
    if array is layout.parameters:
        tangent.parameter_column[list(entries)] = column
    elif array is layout.masses:
        tangent.mass_column[entries[0]] = column
    elif array is layout.free_lengths:
        tangent.rest[entries[0], column] = 1.0
    elif array is layout.velocity:
        tangent.velocity[0, entries[0], column] = np.isfinite(layout.masses[entries[0]])
    else:
        tangent.position[0, entries[0], column] = 1.0
        free = np.isnan(layout.free_lengths)
        tangent.rest[free & (structure.second == entries[0]), column] += structure.direction[free & (structure.second == entries[0])]
        tangent.rest[free & (structure.first == entries[0]), column] -= structure.direction[free & (structure.first == entries[0])]


def record_of(layout: Layout, times: int, columns: int) -> Record:
    """Room for the results; nothing for sensitivities that were not asked for."""
    bodies, joints = len(layout.bodies), len(layout.joints)
    by_body = [np.empty((times, bodies)) for _ in range(3)]
    by_joint = [np.empty((times, joints)) for _ in range(3)]
    rows = times if columns else 0
    body_sensitivities = [np.empty((rows, bodies, columns)) for _ in range(3)]
    joint_sensitivities = [np.empty((rows, joints, columns)) for _ in range(2)]
    return Record(*by_body, *by_joint, *body_sensitivities, *joint_sensitivities)
