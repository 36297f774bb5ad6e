"""The numbers with which one form of a claim acts most like another: compared as forces along a motion, without simulating."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import xarray as xr
from attrs import evolve
from scipy.optimize import least_squares

from crashkit.mechanics.along import Laws, Path, force_along, on_bodies, path_along
from crashkit.misfit import Misfit
from crashkit.model import Model

INSTANTS = 60
"""Of each run."""
EVALUATIONS = 20


def most_alike(present: Misfit, other: Misfit, names: Sequence[str], laws: Laws) -> Mapping[str, float]:
    """Values of some of another model's numbers, so that its forces are those of the present one where that moves.

    minimise sum |F_other(x, v) - F_present(x, v)|^2 over all bodies and instants of the present model's motion, within bounds.
    No force moves what it acts on here, so that a threshold that is off does not spoil everything after it.

    Arguments:
        present, other: misfits of models of the same bodies, at their values.
        names: paths of the numbers that may move; a free length is none of them.
    """
    pairs = {
        frozenset(joint.bodies) for joint in other.model.joints if any(n.startswith(f"joint.{joint.name}.") for n in names)
    }
    motions = [_thinned(present.predictor.motion(run, present.values(present.start()))) for run in present.recordings]
    stills = [np.zeros(motion["position"].shape) for motion in motions]
    acting = _between(present.model, pairs)
    wanted = _forces(acting, laws, _paths(present.model, pairs, motions), stills)
    start, (lower, upper) = other.start(), other.bounds()
    moving = [other.names.index(name) for name in names]
    if not np.any(wanted):
        return other.values(start)

    def values(point: np.ndarray) -> dict[str, float]:
        scaled = start.copy()
        scaled[moving] = point
        return other.values(scaled)

    paths = _paths(other.model, pairs, motions)

    def difference(point: np.ndarray) -> np.ndarray:
        model = _between(other.model.at(values(point)), pairs)
        return (_forces(model, laws, paths, stills) - wanted) / np.linalg.norm(wanted)

    bounds = lower[moving], upper[moving]
    found = least_squares(difference, np.clip(start[moving], *bounds), bounds=bounds, x_scale="jac", max_nfev=EVALUATIONS)
    return values(found.x)


def _between(model: Model, pairs: Collection[frozenset[str]]) -> Model:
    """The model with only the joints between these bodies, of which alone the forces can differ."""
    return evolve(model, joints=tuple(joint for joint in model.joints if frozenset(joint.bodies) in pairs))


def _thinned(motion: xr.Dataset) -> xr.Dataset:
    return motion.isel(time=np.unique(np.linspace(0, motion.sizes["time"] - 1, INSTANTS).astype(int)))


def _paths(model: Model, pairs: Collection[frozenset[str]], motions: Sequence[xr.Dataset]) -> list[list[Path]]:
    """How each motion deforms each joint between these bodies."""
    return [[path_along(model, joint, motion) for joint in _between(model, pairs).joints] for motion in motions]


def _forces(model: Model, laws: Laws, paths: Sequence[Sequence[Path]], stills: Sequence[np.ndarray]) -> np.ndarray:
    """On all bodies, along all motions, N.

    Arguments:
        stills: of each motion (time, body, axis) zeros.
    """
    nets = [on_bodies(model, still, _pushes(model, laws, one)) for one, still in zip(paths, stills, strict=True)]
    return np.concatenate([net.ravel() for net in nets])


def _pushes(model: Model, laws: Laws, paths: Sequence[Path]) -> list[tuple[np.ndarray, np.ndarray]]:
    """What each joint does to its bodies."""
    forces = [
        force_along(joint, laws, path)[:, None] * path.direction for joint, path in zip(model.joints, paths, strict=True)
    ]
    return [(force, force) for force in forces]
