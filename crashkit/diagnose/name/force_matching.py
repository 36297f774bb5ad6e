"""The numbers with which one form of a claim acts most like another: compared as forces along a motion, without simulating."""

from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache

import numpy as np
import xarray as xr
from scipy.optimize import least_squares

from crashkit.errors import SimulationError
from crashkit.mechanics.joint_law import JointLaw
from crashkit.mechanics.joint_track import Track, load_on, shared, track_of
from crashkit.misfit import Misfit
from crashkit.protocols import Laws

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
    names = _with_room(other, names)
    pairs = {
        frozenset(joint.bodies) for joint in other.model.joints if any(n.startswith(f"joint.{joint.name}.") for n in names)
    }
    motions = _motions(present)
    stills = [np.zeros((*motion["position"].shape[:2], 1 if motion.sizes["axis"] == 1 else 6)) for motion in motions]
    wanted = _forces(present, _tracks(present, pairs, laws, motions), stills, {})
    start, (lower, upper) = other.start(), other.bounds()
    moving = [other.names.index(name) for name in names]
    if not names or not np.any(wanted):
        return other.values(start)

    def values(point: np.ndarray) -> dict[str, float]:
        scaled = start.copy()
        scaled[moving] = point
        return other.values(scaled)

    tracks = _tracks(other, pairs, laws, motions)

    def difference(point: np.ndarray) -> np.ndarray:
        return (_forces(other, tracks, stills, values(point)) - wanted) / np.linalg.norm(wanted)

    def slopes(point: np.ndarray) -> np.ndarray:
        scaled = start.copy()
        scaled[moving] = point
        table = _slopes(other, tracks, stills, values(point), names)
        return table * other.scaling(scaled)[moving] / np.linalg.norm(wanted)

    bounds = lower[moving], upper[moving]
    first = np.clip(start[moving], *bounds)
    try:
        found = least_squares(difference, first, slopes, bounds, x_scale="jac", max_nfev=EVALUATIONS)
    except SimulationError:  # a force without slopes
        return values(first)
    return values(found.x)


def _with_room(misfit: Misfit, names: Sequence[str]) -> list[str]:
    """The numbers whose bounds leave them any; a law's may be as large as a force that a joint never had."""
    roomy = {name for name, lower, upper in zip(misfit.names, *misfit.bounds(), strict=True) if lower < upper}
    return [name for name in names if name in roomy]


@lru_cache(maxsize=4)
def _motions(present: Misfit) -> list[xr.Dataset]:
    """Remembered: all forms of a claim are compared with one present one."""
    return [_thinned(present.predictor.motion(run, present.values(present.start()))) for run in present.recordings]


def _thinned(motion: xr.Dataset) -> xr.Dataset:
    return motion.isel(time=np.unique(np.linspace(0, motion.sizes["time"] - 1, INSTANTS).astype(int)))


def _tracks(misfit: Misfit, pairs: Collection[frozenset[str]], laws: Laws, motions: Sequence[xr.Dataset]) -> list[list[Track]]:
    """The joints between these bodies, of which alone the forces can differ, along each motion."""
    joints = [joint for joint in misfit.model.joints if frozenset(joint.bodies) in pairs]
    own = [JointLaw(joint, laws, misfit.simulator.engine) for joint in joints]
    return [[track_of(misfit.model, law, motion) for law in own] for motion in motions]


def _forces(
    misfit: Misfit, tracks: Sequence[Sequence[Track]], stills: Sequence[np.ndarray], values: Mapping[str, float]
) -> np.ndarray:
    """On all bodies, along all motions, N.

    Arguments:
        stills: of each motion (time, body, axis) zeros, with those of moments.
        values: by path, instead of the model's.
    """
    known = misfit.model.values() | dict(values)
    loads = [load_on(still, own, [track.force(known) for track in own]) for still, own in zip(stills, tracks, strict=True)]
    return np.concatenate([load[:, :, :3].ravel() for load in loads])


def _slopes(
    misfit: Misfit,
    tracks: Sequence[Sequence[Track]],
    stills: Sequence[np.ndarray],
    values: Mapping[str, float],
    names: Sequence[str],
) -> np.ndarray:
    """The derivatives of these forces to some numbers, (force, name); arguments as of `_forces`."""
    known = misfit.model.values() | dict(values)
    table = []
    for still, own in zip(stills, tracks, strict=True):
        pushes = [_by_name(track, known, names) for track in own]
        loads = [load_on(still, own, [push[:, column] for push in pushes]) for column in range(len(names))]
        table.append(np.column_stack([load[:, :, :3].ravel() for load in loads]))
    return np.concatenate(table)


def _by_name(track: Track, values: Mapping[str, float], names: Sequence[str]) -> np.ndarray:
    """The derivatives of a joint's force to these numbers, (time, name)."""
    _, slopes = track.push(track.modes(values), values)
    table = np.zeros((len(slopes), len(names)))
    own, places = shared(names, track.paths)
    table[:, own] = slopes[:, places]
    return table
