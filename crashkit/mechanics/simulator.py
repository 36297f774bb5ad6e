"""Simulation of a model, with sensitivities to any of its parameters."""

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from crashkit.errors import CrashkitError, SimulationError
from crashkit.mechanics.adjoint import history_of, seeds_of, sweep_back
from crashkit.mechanics.checks import Allowed, check_step, checked_times
from crashkit.mechanics.engine import Engine, compile_engine
from crashkit.mechanics.given import side_of
from crashkit.mechanics.kernel.arrays import START, Floats, Record, Work
from crashkit.mechanics.kernel.run import DONE, FULL, MEETING, NOT_FINITE
from crashkit.mechanics.layout import Layout, functions_of, installed_laws, lay_out
from crashkit.mechanics.motion import XYZ, motion_of
from crashkit.mechanics.run import prepare, record_of, work_of
from crashkit.model import Model
from crashkit.protocols import Laws

NO_HISTORY = np.empty((0, 0))
"""Of the steps, which only the adjoint needs."""


class Simulator:
    """Runs one model again and again, with other values, initial states and times.

    Arguments:
        model: in one, two or three axes.
        laws: the spring laws and factors by name; None: those that are installed.
        engine: one for as many axes that holds the model's functions (see `functions_of`), to share between models; None:
            one of its own.

    Raises:
        CrashkitError: the model cannot be simulated: a law that is not installed, a parameter without a value.
    """

    def __init__(self, model: Model, laws: Laws | None = None, engine: Engine | None = None) -> None:
        laws = installed_laws() if laws is None else laws
        self.model = model
        self.layout = lay_out(model, laws)
        self._functions = functions_of(model, laws)
        self.engine = compile_engine(self._functions, len(model.axes)) if engine is None else engine
        missing = self._functions - self.engine.codes.keys()
        if missing:
            names = ", ".join(sorted(f"{function.law.name} {function.sizes}" for function in missing))
            raise CrashkitError(f"model {model.name}: expected an engine that holds its functions, found none for {names}")
        if self.engine.axes != len(model.axes):
            found = f"one for {self.engine.axes}"
            raise CrashkitError(f"model {model.name}: expected an engine for {len(model.axes)} axes, found {found}")

    def __repr__(self) -> str:
        return f"Simulator of {self.model!r}"

    @cached_property
    def names(self) -> xr.Coordinates:
        """The coordinates of its motions but for time; made when they are first asked for, as most searches never do."""
        model, joints = self.model, self.model.joints
        sides = [side_of(model, joint) if len(model.axes) == 1 else np.nan for joint in joints]
        return xr.Coordinates(
            {
                "body": list(self.layout.bodies),
                "axis": list(model.axes if len(model.axes) == 1 else XYZ),
                "joint": np.array(self.layout.joints, dtype=str),
                "joint_bodies": (("joint", "end"), np.array([joint.pushed for joint in joints], dtype=str).reshape(-1, 2)),
                "joint_side": ("joint", np.array(sides, dtype=float)),
                "joint_support": ("joint", np.array([joint.support for joint in joints], dtype=bool)),
            }
        )

    @cached_property
    def allowed(self) -> Allowed:
        """The values that users may give to a run."""
        return Allowed.of(self.model, self.layout)

    def run(
        self,
        times: ArrayLike,
        values: Mapping[str, float] | None = None,
        initial: xr.Dataset | None = None,
        sensitivities: Sequence[str] = (),
        step: float = 1e-4,
    ) -> xr.Dataset:
        """The motion at `times`, integrated from t = 0.

        Arguments:
            times: s, increasing, 0 or later; they need not be uniform.
            values: by path, instead of the model's. Besides the model's own parameters, with [i] for an axis where there are
                several: `body.NAME.position`, `.velocity`, `.rotation` (a small rotation from the orientation at t = 0) and
                `.angular_velocity`, `joint.NAME.points[end]`. Those of instruments are ignored.
            initial: `position(body, axis)` and `velocity(body, axis)` at t = 0 of some or all bodies, instead of the
                model's; in several axes also `orientation(body, quaternion)` and `angular_velocity(body, axis)`, if they are
                there.
            sensitivities: paths of the parameters to differentiate to.
            step: s, longest step of the integration.

        Returns:
            A motion of all bodies, with `deformation`, `deformation_rate` and `force` by joint, `contact_force`, the net force
            of its joints on each body, and the coordinates `joint_bodies(joint, end)`, the bodies that a joint pushes, and
            `joint_side(joint)`, the direction in which it pushes the second of them, NaN in several axes. Plane motion and
            space have all three axes, and also `orientation`, `angular_velocity`, `angular_acceleration` and
            `contact_moment`. With sensitivities also `<quantity>_sensitivity`, each with a last dim `parameter`, of all of
            these; that of the orientation is `rotation_sensitivity`, a small rotation vector in the laboratory frame.

        Raises:
            CrashkitError: a path the model does not have, a value that its file could not hold, times or a step that cannot be
                used, or sensitivities of a law that has none.
            SimulationError: the motion is not finite, or it does not get past some time.
        """
        instants = checked_times(times)
        self.allowed.check(values or {})
        return self.motion(instants, values, initial, sensitivities, check_step(step))

    def motion(
        self,
        times: Floats,
        values: Mapping[str, float] | None = None,
        initial: xr.Dataset | None = None,
        sensitivities: Sequence[str] = (),
        step: float = 1e-4,
    ) -> xr.Dataset:
        """The same for searches: arguments as of `run`, the times, the values and the step unchecked."""
        record = self.record(times, values, initial, sensitivities, step)
        return motion_of(record, times, self.model.axes, self.names, sensitivities)

    def record(
        self,
        times: Floats,
        values: Mapping[str, float] | None = None,
        initial: xr.Dataset | None = None,
        sensitivities: Sequence[str] = (),
        step: float = 1e-4,
    ) -> Record:
        """The same as plain arrays, without the cost of a Dataset; arguments as of `motion`."""
        if sensitivities:
            self.engine.check_derivatives(self._functions)
        layout = prepare(self.layout, values or {}, initial)
        work = work_of(layout, self.engine, sensitivities)
        instants = with_knots(times, layout)
        record = record_of(work, len(layout.axes), instants.size)
        status, joint, t, _ = self.engine.module.integrate(instants, instants, float(step), *work, *record, NO_HISTORY)
        if status != DONE:
            raise SimulationError(self.sentence(status, joint, t))
        if instants is times:
            return record
        asked = np.searchsorted(instants, times)
        tangents = record.tangents[asked] if sensitivities else record.tangents
        return Record(record.values[asked], tangents, record.slots)

    def adjoint(
        self,
        times: ArrayLike,
        weights: xr.Dataset,
        values: Mapping[str, float] | None = None,
        initial: xr.Dataset | None = None,
        parameters: Sequence[str] | None = None,
        step: float = 1e-4,
    ) -> xr.DataArray:
        """The gradient of sum(weights x motion) to any number of parameters, at the cost of a few runs.

        Arguments:
            times, values, initial, step: as of `run`.
            weights: over the dims of a motion at `times`, for any of its quantities that have a sensitivity; a weight of a
                small rotation is `rotation`.
            parameters: paths to differentiate to; None: the model's free parameters.

        Returns:
            The derivative to each parameter, dim `parameter`.

        Raises:
            CrashkitError: a law that has no derivatives; a quantity that a motion does not have; what `run` refuses.
        """
        instants = checked_times(times)
        self.allowed.check(values or {})
        paths = list(self.model.free_parameters() if parameters is None else parameters)
        seeds = seeds_of(weights, instants, self.model.axes, self.names)
        gradient = self.gradient(instants, seeds, paths, values, initial, check_step(step))
        return xr.DataArray(gradient, {"parameter": paths}, ["parameter"], name="gradient")

    def gradient(
        self,
        times: Floats,
        seeds: Floats,
        parameters: Sequence[str],
        values: Mapping[str, float] | None = None,
        initial: xr.Dataset | None = None,
        step: float = 1e-4,
    ) -> Floats:
        """The same from plain arrays: `seeds` (time, entry) are the weights of a record's entries, all but memories and
        quaternions."""
        self.engine.check_derivatives(self._functions)
        layout = prepare(self.layout, values or {}, initial)
        work = work_of(layout, self.engine, ())
        instants = with_knots(times, layout)
        history, steps = self._history(layout, work, instants, float(step))
        return sweep_back(layout, work, self.engine, history, steps, np.searchsorted(instants, times), seeds, parameters)

    def _history(self, layout: Layout, work: Work, instants: Floats, step: float) -> tuple[Floats, int]:
        """The steps of a run, and how many they are; again with more room until they fit."""
        room, start = int(instants[-1] / step) + 2 * instants.size + 100, work.state[START].copy()
        rests = work.joints["rest"].copy()
        while True:
            history = history_of(work, len(layout.axes), room)
            record = record_of(work, len(layout.axes), instants.size)
            status, joint, t, steps = self.engine.module.integrate(instants, instants, step, *work, *record, history)
            if status == DONE:
                return history, steps
            if status != FULL:
                raise SimulationError(self.sentence(status, joint, t))
            room *= 2
            work.state[START], work.joints["rest"] = start, rests

    def sentence(self, status: int, number: int, t: float) -> str:
        """How a run ended, in words: status, joint and time as the kernel returns them."""
        if status == DONE:
            return "completed"
        joint = self.model.joints[number]
        place = f"joint {joint.name} between {joint.bodies[0]} and {joint.bodies[1]} at t = {t:.6g} s"
        if status == NOT_FINITE:
            problem = self.engine.problem()
            return f"model {self.model.name}: the force of {place} is not finite{problem and f' ({problem})'}"
        if status == MEETING:
            remedy = "the line between them has no direction; give the joint a normal if it is a contact with a face"
            return f"model {self.model.name}: the attachments of {place} meet: {remedy}"
        return f"model {self.model.name}: no progress past the branches of {place}: its law may jump there"


def simulate(
    model: Model,
    times: ArrayLike,
    laws: Laws | None = None,
    values: Mapping[str, float] | None = None,
    initial: xr.Dataset | None = None,
    sensitivities: Sequence[str] = (),
    step: float = 1e-4,
) -> xr.Dataset:
    """The motion of a model at `times`: one `Simulator.run`; `laws` None: those that are installed."""
    return Simulator(model, laws).run(times, values, initial, sensitivities, step)


def with_knots(times: Floats, layout: Layout) -> Floats:
    """These times, and those before the last at which what is given changes its slope: steps end there."""
    knots = layout.given[:, 0]
    return np.union1d(times, knots[knots < times[-1]]) if knots.size > 1 else times
