"""What motions and recordings say of sizes, to start a search from: how far, how fast, how hard; which bodies come closer."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
import xarray as xr

from crashkit.model import Joint, Model

SAME = 0.02
"""Of the largest force: forces that differ by less are the same."""
NEARER = 1e-3
"""m, least approach of two bodies that may touch."""


def of_joint(motion: xr.Dataset, quantity: str, joint: str) -> np.ndarray:
    """A quantity of one joint, (time,). From a bare variable: hypotheses ask hundreds of times, and named arrays take long."""
    row = motion.variables["joint"].values.tolist().index(joint)
    return np.asarray(motion.variables[quantity].transpose("time", "joint").values[:, row])


def of_body(motion: xr.Dataset, quantity: str, body: str) -> np.ndarray:
    """A quantity of one body, (time, axis)."""
    row = motion.variables["body"].values.tolist().index(body)
    return np.asarray(motion.variables[quantity].transpose("time", "body", "axis").values[:, row])


def duration(motions: Sequence[xr.Dataset]) -> float:
    """s, of the longest run."""
    return max(float(motion["time"].values[-1]) for motion in motions)


def largest_deformation(motions: Sequence[xr.Dataset], joint: str) -> float:
    """m, over all runs."""
    return max(float(np.nanmax(of_joint(motion, "deformation", joint))) for motion in motions)


def largest_extension(motions: Sequence[xr.Dataset], joint: str) -> float:
    """m, over all runs; 0 where it was never stretched."""
    return max(float(-np.nanmin(of_joint(motion, "deformation", joint), initial=0.0)) for motion in motions)


def largest_recoil(motions: Sequence[xr.Dataset], joint: str) -> float:
    """m, from the largest deformation back, over all runs."""
    deformations = [of_joint(motion, "deformation", joint) for motion in motions]
    return max(float(np.nanmax(np.fmax.accumulate(deformation) - deformation)) for deformation in deformations)


def pulls(motions: Sequence[xr.Dataset], joint: str) -> bool:
    """Whether a joint pulled in some run."""
    stretched = largest_extension(motions, joint) > 0.0
    return stretched and min(float(np.nanmin(of_joint(one, "force", joint))) for one in motions) < 0.0


def is_compressed(motions: Sequence[xr.Dataset], joint: str) -> bool:
    """Whether a joint is compressed in some run."""
    return largest_deformation(motions, joint) > 0.0


def gives_all_back(motions: Sequence[xr.Dataset], joint: str) -> bool:
    """Whether the force of a joint is the same on the way out and on the way back, in all runs."""
    return all(_returned(of_joint(one, "deformation", joint), of_joint(one, "force", joint)) for one in motions)


def _returned(deformation: np.ndarray, force: np.ndarray) -> bool:
    turn = int(np.nanargmax(deformation))
    out, back = slice(turn + 1), slice(turn, None)
    loading = np.interp(deformation[back], np.maximum.accumulate(deformation[out]), force[out])
    return bool(np.abs(loading - force[back]).max() <= SAME * np.abs(force).max())


def compressed(model: Model, motions: Sequence[xr.Dataset]) -> list[Joint]:
    """The joints that are compressed in some run."""
    return [joint for joint in model.joints if is_compressed(motions, joint.name)]


def largest_force(motions: Sequence[xr.Dataset], joint: str) -> float:
    """N, over all runs."""
    return max(float(np.nanmax(np.abs(of_joint(motion, "force", joint)))) for motion in motions)


def largest_rate(motions: Sequence[xr.Dataset], joint: str) -> float:
    """m s-1, over all runs."""
    return max(float(np.nanmax(np.abs(of_joint(motion, "deformation_rate", joint)))) for motion in motions)


def largest_speed(motions: Sequence[xr.Dataset], body: str | None = None) -> float:
    """m s-1 along an axis, of one body or of any, over all runs."""
    velocities = [
        motion.variables["velocity"].values if body is None else of_body(motion, "velocity", body) for motion in motions
    ]
    return max(float(np.nanmax(np.abs(velocity))) for velocity in velocities)


def largest_travel(motions: Sequence[xr.Dataset], body: str) -> float:
    """m, from where a body was at t = 0, over all runs."""
    return max(_travel(of_body(motion, "position", body)) for motion in motions)


def _travel(position: np.ndarray) -> float:
    return float(np.linalg.norm(position - position[0], axis=1).max())


def largest_approach(motions: Sequence[xr.Dataset], first: str, second: str) -> float:
    """m, by how much two bodies come closer than they were at t = 0, over all runs."""
    return max(_approach(of_body(motion, "position", first) - of_body(motion, "position", second)) for motion in motions)


def approaching(model: Model, motions: Sequence[xr.Dataset]) -> dict[tuple[str, str], float]:
    """The pairs of bodies without a joint that come closer than they were, and by how much, m."""
    joined = {frozenset(joint.bodies) for joint in model.joints}
    pairs = [(a, b) for a, b in combinations(model.bodies, 2) if not (a.fixed and b.fixed) and a.position != b.position]
    free = [(a.name, b.name) for a, b in pairs if {a.name, b.name} not in joined]
    reached = {pair: largest_approach(motions, *pair) for pair in free}
    return {pair: approach for pair, approach in reached.items() if approach > NEARER}


def _approach(separation: np.ndarray) -> float:
    distance = np.linalg.norm(separation, axis=1)
    return float(distance[0] - distance.min())


def forces_recorded(recordings: Sequence[xr.DataTree]) -> bool:
    """Whether a load cell is among the instruments."""
    return any("force" in group.data_vars for recording in recordings for group in recording.children.values())


def sampling_interval(recordings: Sequence[xr.DataTree]) -> float:
    """s, of the fastest instrument; 1 ms where there is none."""
    groups = [group.to_dataset(inherit=False) for recording in recordings for group in recording.children.values()]
    stamps = [group["time"].values for group in groups if group.sizes.get("time", 0) > 1]
    return min((float(np.median(np.diff(times))) for times in stamps), default=1e-3)


def braked_axis(motions: Sequence[xr.Dataset], body: str) -> str:
    """The axis along which the velocity of a body changes most, over all runs."""
    changes = [np.ptp(of_body(motion, "velocity", body), axis=0) for motion in motions]
    return str(motions[0]["axis"].values[np.max(changes, axis=0).argmax()])
