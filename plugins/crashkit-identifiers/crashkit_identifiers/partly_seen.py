"""The equations of motion of the bodies that are seen, while those that are not are simulated beside them."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.mechanics import Simulator
from crashkit.mechanics.kernel.arrays import Record
from crashkit.mechanics.repeated_run import FORCE, RepeatedRun, entry_of
from crashkit.misfit import Misfit
from crashkit.misfit.predictor import initial_state
from crashkit_identifiers.measured import known, require_seen, weights
from crashkit_identifiers.rails import on_rails
from crashkit_identifiers.recorded import engine_of, laws_of


class PartlySeen:
    """m a = F of each body that is seen, in one axis, while those that are not move as the model says.

    A load that a body carries, or a neighbour without an instrument, is pushed by bodies that move as they were measured, so
    it cannot lead the others astray.

    Arguments:
        misfit: of the model to the recordings.
        run: its name.
        motion: measured.
        step: s, longest of the simulation.

    Raises:
        CrashkitError: the model has several axes, nothing that moves is seen, or a force is given of what is.
    """

    def __init__(self, misfit: Misfit, run: str, motion: xr.Dataset, step: float) -> None:
        model = misfit.model
        seen = [body for body in model.bodies if body.is_free and bool(motion["seen"].sel(body=body.name))]
        if len(model.axes) > 1 or not seen or any(body.force for body in seen):
            require_seen(misfit, {run: motion}, "state_form")
        motion = known(motion.sel(body=[body.name for body in seen]))
        bodies = tuple(on_rails(model, body, motion) if body in seen else body for body in model.bodies)
        self._masses = [f"body.{body.name}.mass" for body in seen]
        self._paths = [path for path in misfit.names if not path.startswith("instrument.") and path not in self._masses]
        self._gravity = model.gravity[0] if model.gravity else 0.0
        simulator = Simulator(evolve(model, bodies=bodies, instruments=()), laws_of(misfit), engine_of(misfit))
        initial = _initial(misfit, run, [body.name for body in bodies if body.is_free])
        pushed = [entry_of(simulator, FORCE, body.name, model.axes[0]) for body in seen]
        wanted = [entry for entry in pushed if entry is not None]
        self._run = RepeatedRun(simulator, motion["time"].values, self._paths, None, initial, step, wanted=wanted)
        self._measured = motion["acceleration"].values[:, :, 0]
        self._weight = weights(motion["acceleration_std"].values[:, :, 0])

    def residual(self, values: Mapping[str, float]) -> np.ndarray:
        """What the equations leave of the measured accelerations, over their noise."""
        return self._left(self._forces(values, False).values, self._masses_at(values)).ravel()

    def residual_and_jacobian(self, values: Mapping[str, float], names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        """The same, and its derivatives."""
        (forces, slopes, _), masses = self._forces(values, True), self._masses_at(values)
        residual = self._left(forces, masses)
        jacobian = np.zeros((*residual.shape, len(names)))
        jacobian[..., [names.index(path) for path in self._paths]] = -slopes / masses[:, None] * self._weight[:, None]
        for row, path in enumerate(self._masses):
            if path in names:
                jacobian[:, row, names.index(path)] = forces[:, row] / masses[row] ** 2 * self._weight[row]
        return residual.ravel(), jacobian.reshape(-1, len(names))

    def _forces(self, values: Mapping[str, float], sensitivities: bool) -> Record:
        """On the bodies that are seen, N, and the derivatives of these."""
        return self._run.record(np.array([values[path] for path in self._paths], dtype=float), sensitivities)

    def _masses_at(self, values: Mapping[str, float]) -> np.ndarray:
        return np.array([values[path] for path in self._masses])

    def _left(self, forces: np.ndarray, masses: np.ndarray) -> np.ndarray:
        left: np.ndarray = (self._measured - self._gravity - forces / masses) * self._weight
        return left


def _initial(misfit: Misfit, run: str, free: Sequence[str]) -> xr.Dataset | None:
    """The recorded state at t = 0 of the bodies that are simulated."""
    state = initial_state(misfit.recordings[run], misfit.model)
    return None if state is None else state.isel(body=np.isin(state["body"].values, list(free)))
