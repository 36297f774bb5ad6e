"""Simulation of a model in one axis, with sensitivities to any of its parameters."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from crashkit.errors import CrashkitError, SimulationError
from crashkit.mechanics.arrays import Floats
from crashkit.mechanics.engine import Engine, compile_engine
from crashkit.mechanics.kernel import DONE, NOT_FINITE
from crashkit.mechanics.layout import Laws, functions_of, lay_out
from crashkit.mechanics.motion import motion_of
from crashkit.mechanics.run import prepare, record_of, work_of
from crashkit.model import Model


class Simulator:
    """Runs one model again and again, with other values, initial states and times.

    Arguments:
        model: in one axis.
        laws: the spring laws and factors by name.
        engine: one that holds the model's functions (see `functions_of`), to share between models; None: one of its own.

    Raises:
        CrashkitError: the model cannot be simulated: a law that is not installed, a parameter without a value, several axes.
    """

    def __init__(self, model: Model, laws: Laws, engine: Engine | None = None) -> None:
        self.model = model
        self._layout = lay_out(model, laws)
        self.engine = compile_engine(functions_of(model, laws)) if engine is None else engine
        missing = functions_of(model, laws) - self.engine.numbers.keys()
        if missing:
            names = ", ".join(sorted(f"{function.law.name} {function.sizes}" for function in missing))
            raise CrashkitError(f"model {model.name}: expected an engine that holds its functions, found none for {names}")
        ends = np.array([joint.bodies for joint in model.joints], dtype=str).reshape(-1, 2)
        self._names = xr.Coordinates(
            {
                "body": list(self._layout.bodies),
                "axis": list(model.axes),
                "joint": np.array(self._layout.joints, dtype=str),
                "joint_bodies": (("joint", "end"), ends),
            }
        )

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
            values: by path, instead of the model's; also `body.NAME.position` and `body.NAME.velocity`. Those of instruments
                are ignored.
            initial: `position(body, axis)` and `velocity(body, axis)` at t = 0 of some or all bodies, instead of the model's.
            sensitivities: paths of the parameters to differentiate to.
            step: s, longest step of the integration.

        Returns:
            A motion of all bodies, with `deformation`, `deformation_rate` and `force` by joint, `contact_force`, the net force
            of its joints on each body, and the coordinate `joint_bodies(joint, end)`; with sensitivities also
            `<quantity>_sensitivity`, each with a last dim `parameter`, of all of these but the deformation rate.

        Raises:
            CrashkitError: a path the model does not have, or times that cannot be used.
            SimulationError: the motion is not finite, or it does not get past some time.
        """
        instants = _checked(times)
        layout = prepare(self._layout, values or {}, initial)
        work = work_of(layout, self.engine, sensitivities)
        record = record_of(work, instants.size)
        status, joint, t = self.engine.module.integrate(instants, float(step), *work, *record)
        if status != DONE:
            raise SimulationError(self._failure(status, joint, t))
        return motion_of(record, work, instants, self._names, sensitivities)

    def _failure(self, status: int, number: int, t: float) -> str:
        joint = self.model.joints[number]
        place = f"joint {joint.name} between {joint.bodies[0]} and {joint.bodies[1]} at t = {t:.6g} s"
        if status == NOT_FINITE:
            return f"model {self.model.name}: the force of {place} is not finite"
        return f"model {self.model.name}: no progress past the branches of {place}: its law may jump there"


def simulate(
    model: Model,
    times: ArrayLike,
    laws: Laws,
    values: Mapping[str, float] | None = None,
    initial: xr.Dataset | None = None,
    sensitivities: Sequence[str] = (),
    step: float = 1e-4,
) -> xr.Dataset:
    """The motion of a model at `times`: one `Simulator.run`."""
    return Simulator(model, laws).run(times, values, initial, sensitivities, step)


def _checked(times: ArrayLike) -> Floats:
    instants = np.ascontiguousarray(times, dtype=float)
    if instants.ndim != 1 or instants.size == 0 or not np.all(np.isfinite(instants)):
        raise CrashkitError(f"expected times in one dimension, all finite, found an array of shape {instants.shape}")
    if instants[0] < 0.0 or np.any(np.diff(instants) <= 0.0):
        raise CrashkitError("expected times that increase from 0 or later, found times that go back or begin before 0")
    return instants
