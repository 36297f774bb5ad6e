"""One run of a model, again and again at other values: what stays the same is prepared once."""

import threading
from collections import OrderedDict
from collections.abc import Collection, Hashable, Mapping, Sequence

import numpy as np
import xarray as xr

from crashkit.errors import SimulationError
from crashkit.mechanics.given import side_of
from crashkit.mechanics.kernel.arrays import START, Floats, Integers, Record, Work
from crashkit.mechanics.kernel.run import DONE
from crashkit.mechanics.layout import DOF, Place
from crashkit.mechanics.motion import arrays_of, motion_of
from crashkit.mechanics.run import bodies_of, joints_of, prepare, record_of, work_of
from crashkit.mechanics.simulator import NO_HISTORY, Simulator, with_knots

FORCE = "contact_force"
BY_BODY = ("position", "velocity", "acceleration", FORCE)
"""Quantities that a record holds for each body and axis."""
TURN = "turn"
"""Instead of an axis of the plane: about its normal."""
ROOMS = 8
"""Records that are kept for the next run of the same size: hundreds of models may take turns, each with some megabytes."""
_kept = threading.local()


class RepeatedRun:
    """A run whose values change and nothing else, at the cost of the compiled kernel.

    Arguments:
        simulator: of the model.
        times: s, increasing, from 0 or later.
        paths: of the parameters that change from run to run.
        values: by path, of others that keep a value that is not the model's.
        initial: the state at t = 0, as `Simulator.run` takes it.
        step: s, longest step of the integration.
        ends_at_all: whether a step ends at each of the times; between the ends of steps orientations in space are not known.
        wanted: the entries that a record holds; None: all. To write those of no use took up to three quarters of a run.
    """

    def __init__(
        self,
        simulator: Simulator,
        times: Floats,
        paths: Sequence[str],
        values: Mapping[str, float] | None = None,
        initial: xr.Dataset | None = None,
        step: float = 1e-4,
        ends_at_all: bool = True,
        wanted: Collection[int] | None = None,
    ) -> None:
        self.times, self.paths = times, tuple(paths)
        self._simulator, self._step = simulator, step
        self._wanted = None if wanted is None else frozenset(wanted)
        self._layout = prepare(simulator.layout, values or {}, initial)
        self._places = [self._layout.place(path) for path in paths]
        self._structural = [column for column, (name, _) in enumerate(self._places) if name != "parameters"]
        self._entries, self._columns = _of_laws(self._places)
        self.stops = with_knots(times if ends_at_all else times[-1:], self._layout)
        self._arrays: dict[bool, tuple[Work, Work]] = {}
        self._blank: dict[tuple[str, ...], xr.Dataset] = {}

    def record(self, values: Floats, sensitivities: bool = False) -> Record:
        """The run at these values of `paths`; its arrays are overwritten by the next run in this thread, of whichever model.

        Raises:
            SimulationError: the motion is not finite, or it does not get past some time.
        """
        self._layout.parameters[self._entries] = values[self._columns]
        for column in self._structural:
            name, index = self._places[column]
            getattr(self._layout, name)[index] = values[column]
        work = self._begin(sensitivities)
        record = _room(work, len(self._layout.axes), self.times.size, self._wanted)
        integrate = self._simulator.engine.module.integrate
        status, joint, t, _ = integrate(self.times, self.stops, self._step, *work, *record, NO_HISTORY)
        if status != DONE:
            raise SimulationError(self._simulator.sentence(status, joint, t))
        return record

    def motion(self, record: Record) -> xr.Dataset:
        """What a record of all entries tells, as `Simulator.run` returns it."""
        paths = self.paths if record.tangents.shape[0] else ()
        own = Record(record.values.copy(), record.tangents.copy(), record.slots)
        axes, names = self._layout.axes, self._simulator.names
        if paths in self._blank:  # to put a Dataset together costs more than a short run
            return self._blank[paths].copy(data=arrays_of(own, axes, names))
        motion = motion_of(own, self.times, axes, names, paths)
        self._blank[paths] = _blank(motion)
        return motion

    def _begin(self, sensitivities: bool) -> Work:
        """The arrays as they are at t = 0."""
        if sensitivities not in self._arrays:
            self._arrays[sensitivities] = self._prepared(self.paths if sensitivities else ())
        work, first = self._arrays[sensitivities]
        for array, start in zip(work, first, strict=True):
            if array is not work.parameters:
                array[...] = start
        if self._structural:
            self._renew(work)
        return work

    def _prepared(self, paths: tuple[str, ...]) -> tuple[Work, Work]:
        """The arrays of the kernel, and a copy of them at t = 0."""
        work = work_of(self._layout, self._simulator.engine, paths)
        first = Work(*(array.copy() for array in work))  # type: ignore[arg-type]
        return work, first

    def _renew(self, work: Work) -> None:
        """Masses, inertia, lengths, points and the initial state."""
        bodies, joints = bodies_of(self._layout), joints_of(self._layout)
        for name in ("inverse_mass", "inertia"):
            work.bodies[name] = bodies[name]
        for name in ("rest", "places"):
            work.joints[name] = joints[name]
        work.state[START, : self._layout.start.size] = self._layout.start.ravel()


def _of_laws(places: Sequence[Place]) -> tuple[Integers, Integers]:
    """The entries of laws' parameters among these places, and the number of the place that each belongs to."""
    pairs = [(entry, column) for column, (name, index) in enumerate(places) if name == "parameters" for entry in index[0]]
    entries, columns = np.array(pairs, int).reshape(-1, 2).T
    return entries, columns


def entry_of(simulator: Simulator, quantity: str, body: str, axis: str) -> int | None:
    """Where a record of a model's runs holds a quantity of `BY_BODY`; None where it does not."""
    layout = simulator.layout
    axes, bodies = layout.axes, layout.bodies
    if quantity not in BY_BODY or axis not in (*axes, *([TURN] if len(axes) == 2 else [])):
        return None
    dof, twice = DOF[len(axes)], _of_joints(simulator)
    velocities = dof * len(bodies)
    starts = (0, velocities, twice // 2 + velocities, twice + 3 * len(layout.joints))
    return starts[BY_BODY.index(quantity)] + dof * bodies.index(body) + (*axes, TURN).index(axis)


def supports_of(simulator: Simulator, body: str) -> dict[int, float]:
    """What holds a body on a line, which a record's force on it counts and a load cell does not feel: by entry, times what."""
    held = {}
    for number, joint in enumerate(simulator.model.joints):
        if joint.support and body in joint.pushed:
            side = side_of(simulator.model, joint)
            held[_of_joints(simulator) + 3 * number] = side if joint.pushed[1] == body else -side
    return held


def _of_joints(simulator: Simulator) -> int:
    """Where a record's entries of joints begin, after the state and its derivative."""
    layout = simulator.layout
    memories = sum(bool(function.law.memory) for own in layout.functions for function in own)
    return 2 * (2 * DOF[len(layout.axes)] * len(layout.bodies) + memories)


def _blank(motion: xr.Dataset) -> xr.Dataset:
    """A motion to be filled in, whose own numbers take no memory."""
    return motion.copy(data={str(name): np.broadcast_to(0.0, values.shape) for name, values in motion.data_vars.items()})


def _room(work: Work, axes: int, times: int, wanted: frozenset[int] | None) -> Record:
    """Room for the results, of a run before this one if there was one of this size."""
    rooms: OrderedDict[Hashable, Record] = _kept.__dict__.setdefault("rooms", OrderedDict())
    size = (*work.tangent.shape[1:], len(work.joints), len(work.bodies), axes, times, wanted)
    rooms[size] = rooms.pop(size) if size in rooms else record_of(work, axes, times, wanted)
    if len(rooms) > ROOMS:
        rooms.popitem(last=False)
    return rooms[size]
