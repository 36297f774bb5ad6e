"""The misfit of the equations of motion themselves: measured accelerations against forces at the measured state."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from crashkit.mechanics.state_form import StateForm
from crashkit.misfit import Misfit, SameVariables
from crashkit_identifiers.measured import known, unseen, weights
from crashkit_identifiers.partly_seen import PartlySeen
from crashkit_identifiers.recorded import engine_of, laws_of


class EquationError(SameVariables):
    """r = (a - f(X) U - g(X)) / s over every instant and body that forces move (Mizzi & Jezequel 1992, eq 33).

    The accelerations a and the states X are measured; in one axis, bodies that nobody saw are simulated beside them. So no
    error of one body leads another astray; but the noise of X biases the forces, and smoothing rounds their corners.

    Arguments:
        misfit: of the model to the recordings.
        measured: the motion of each run, as `measured_motion` gives it.
        step: s, longest of the simulation of bodies that nobody saw.
    """

    def __init__(self, misfit: Misfit, measured: Mapping[str, xr.Dataset], step: float) -> None:
        super().__init__(misfit)
        self.misfit = misfit
        self._runs = [
            PartlySeen(misfit, run, motion, step) if unseen(misfit, motion) else Seen(misfit, motion)
            for run, motion in measured.items()
        ]

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the equations leave of the measured accelerations, and its derivatives to the search variables."""
        values = self._values(scaled)
        parts = [run.residual_and_jacobian(values, self.names) for run in self._runs]
        residual, jacobian = (np.concatenate(side) for side in zip(*parts, strict=True))
        return residual, jacobian * self.scaling(scaled)

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """What the equations leave of the measured accelerations."""
        values = self._values(scaled)
        return np.concatenate([run.residual(values) for run in self._runs])

    def _values(self, scaled: np.ndarray) -> dict[str, float]:
        return self.misfit.model.values() | self.misfit.values(scaled)


class Seen:
    """The equations along the measured motion of one run that every body is seen in."""

    def __init__(self, misfit: Misfit, motion: xr.Dataset) -> None:
        motion = known(motion)
        self._form = StateForm(misfit.model, laws_of(misfit), motion, engine_of(misfit))
        self._moving = [row for row, body in enumerate(misfit.model.bodies) if body.is_free]
        names = [name for name in ("acceleration", "angular_acceleration") if name in motion]
        self._measured = np.concatenate([motion[name].values for name in names], axis=2)[:, self._moving]
        std = np.concatenate([motion[f"{name}_std"].values for name in names], axis=2)[:, self._moving]
        self._weight = weights(std)

    def residual(self, values: Mapping[str, float]) -> np.ndarray:
        return self.residual_and_jacobian(values, self._form.paths)[0]

    def residual_and_jacobian(self, values: Mapping[str, float], names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        acceleration, matrix = self._form.at(values, self._form.modes(values))
        residual = (self._measured - acceleration[:, self._moving]) * self._weight
        slopes = np.zeros((*residual.shape, len(names)))
        columns = [names.index(path) for path in self._form.paths]
        slopes[..., columns] = -matrix[:, self._moving] * self._weight[..., None]
        return residual.ravel(), slopes.reshape(residual.size, len(names))
