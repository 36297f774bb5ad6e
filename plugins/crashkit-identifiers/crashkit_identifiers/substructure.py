"""One body with its joints, its neighbours moving as they were measured: a small problem cut out of a large one."""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from attrs import evolve

from crashkit.mechanics import Engine
from crashkit.misfit import Misfit
from crashkit.model import Model
from crashkit_identifiers.measured import known
from crashkit_identifiers.rails import on_rails
from crashkit_identifiers.recorded import laws_of


class Substructure:
    """The misfit of one body to its own recordings, over the parameters that its motion depends on; a Problem.

    Arguments:
        misfit: of the whole model.
        measured: the motion of each run.
        body: a moving one.
        engine: of the whole model.

    Attributes:
        names: of the parameters: its mass and inertia, and those of the joints that hold it.
        places: of these among the names of the whole problem.
    """

    def __init__(self, misfit: Misfit, measured: Mapping[str, xr.Dataset], body: str, engine: Engine) -> None:
        observers = {group.observer.name: type(group.observer) for group in misfit.groups}
        laws = laws_of(misfit)
        self._parts = [
            Misfit(_cut(misfit.model, body, motion), {run: _own(misfit, run, body)}, laws, observers, engine)
            for run, motion in measured.items()
        ]
        self.names = self._parts[0].names
        self.places = [misfit.names.index(name) for name in self.names]

    def start(self) -> np.ndarray:
        """The model's own values."""
        return self._parts[0].start()

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Those of the model."""
        return self._parts[0].bounds()

    def parameters(self, scaled: np.ndarray) -> np.ndarray:
        """The parameters in their own units."""
        return self._parts[0].parameters(scaled)

    def scaling(self, scaled: np.ndarray) -> np.ndarray:
        """d parameter / d search variable."""
        return self._parts[0].scaling(scaled)

    def residual(self, scaled: np.ndarray) -> np.ndarray:
        """The residuals of all runs."""
        return np.concatenate([part.residual(scaled) for part in self._parts])

    def residual_and_jacobian(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The residuals of all runs and their derivatives."""
        residuals, jacobians = zip(*(part.residual_and_jacobian(scaled) for part in self._parts), strict=True)
        return np.concatenate(residuals), np.concatenate(jacobians)


def _cut(model: Model, name: str, motion: xr.Dataset) -> Model:
    """The body, its joints, and its neighbours on rails."""
    joints = tuple(joint for joint in model.joints if name in joint.pushed)
    near = {end for joint in joints for end in (*joint.bodies, *joint.pushed)}
    bodies = [body for body in model.bodies if body.name in near]
    cut = tuple(body if body.name == name or body.fixed else on_rails(model, body, known(motion)) for body in bodies)
    return evolve(model, bodies=cut, joints=joints, instruments=())


def _own(misfit: Misfit, run: str, body: str) -> xr.DataTree:
    """What the recording of a run tells of one body."""
    groups = {}
    for group in (g for g in misfit.groups if g.run == run):
        carriers = group.dataset[f"{group.observer.channel}_body"].values.astype(str)
        if (carriers == body).any():
            groups[group.name] = xr.DataTree(group.dataset.isel({group.observer.channel: carriers == body}))
    state = misfit.recordings[run].children.get("initial")
    if state is not None and body in state.to_dataset(inherit=False)["body"].values:
        groups["initial"] = xr.DataTree(state.to_dataset(inherit=False).sel(body=[body]))
    return xr.DataTree(children=groups)
