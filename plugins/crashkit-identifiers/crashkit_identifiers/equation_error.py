"""The misfit of the equations of motion themselves: measured accelerations against forces at the measured state."""

from collections.abc import Mapping, Sequence

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
        self._parts = _parts(misfit, measured, step)

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the equations leave of the measured accelerations, and its derivatives to the search variables."""
        values = self._values(scaled)
        parts = [part.residual_and_jacobian(values, self.names) for part in self._parts]
        residual, jacobian = (np.concatenate(side) for side in zip(*parts, strict=True))
        return residual, jacobian * self.scaling(scaled)

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """What the equations leave of the measured accelerations."""
        values = self._values(scaled)
        return np.concatenate([part.residual(values) for part in self._parts])

    def _values(self, scaled: np.ndarray) -> dict[str, float]:
        return self.misfit.model.values() | self.misfit.values(scaled)


class Seen:
    """The equations along the measured motions of runs that every body is seen in, end to end: one evaluation of all takes
    little longer than one of each."""

    def __init__(self, misfit: Misfit, motions: Sequence[xr.Dataset]) -> None:
        motions = [known(motion) for motion in motions]
        end_to_end = xr.concat(motions, "time", data_vars="minimal", coords="minimal", compat="override", join="override")
        self._form = StateForm(misfit.model, laws_of(misfit), end_to_end, engine_of(misfit))
        self._moving = [row for row, body in enumerate(misfit.model.bodies) if body.is_free]
        self._measured = np.concatenate([self._accelerations(motion, "") for motion in motions])
        stds = [self._accelerations(motion, "_std") for motion in motions]
        self._weight = np.concatenate([np.broadcast_to(weights(std), std.shape) for std in stds])

    def _accelerations(self, motion: xr.Dataset, suffix: str) -> np.ndarray:
        """Of the bodies that move, (time, body, axis), the angular ones last; or their standard deviations."""
        names = [name for name in ("acceleration", "angular_acceleration") if name in motion]
        return np.concatenate([motion[f"{name}{suffix}"].values for name in names], axis=2)[:, self._moving]

    def residual(self, values: Mapping[str, float]) -> np.ndarray:
        return self.residual_and_jacobian(values, self._form.paths)[0]

    def residual_and_jacobian(self, values: Mapping[str, float], names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        acceleration, matrix = self._form.at(values, self._form.modes(values))
        residual = (self._measured - acceleration[:, self._moving]) * self._weight
        slopes = np.zeros((*residual.shape, len(names)))
        columns = [names.index(path) for path in self._form.paths]
        slopes[..., columns] = -matrix[:, self._moving] * self._weight[..., None]
        return residual.ravel(), slopes.reshape(residual.size, len(names))


def _parts(misfit: Misfit, measured: Mapping[str, xr.Dataset], step: float) -> list[Seen | PartlySeen]:
    """The equations of each run in turn; of all runs at once where every body is seen in each."""
    partly = [run for run, motion in measured.items() if unseen(misfit, motion)]
    if not partly:
        return [Seen(misfit, list(measured.values()))]
    return [
        PartlySeen(misfit, run, motion, step) if run in partly else Seen(misfit, [motion]) for run, motion in measured.items()
    ]
