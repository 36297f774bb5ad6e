"""The motion of bodies from the positions of the markers that they carry."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from crashkit_cameras.rigid import Pose, fit_pose

NEEDED = {2: "two markers apart", 3: "three markers that are not on one line"}


def body_motion(
    instrument: xr.Dataset, positions: np.ndarray, covariance: np.ndarray | None, response: np.ndarray
) -> xr.Dataset:
    """Where the bodies are at each time stamp, and how they are turned.

    Arguments:
        instrument: with `marker_body`, `marker_point` and the coordinates `time` and `axis`.
        positions: of the markers, (time, marker, axis), m, NaN where hidden.
        covariance: of each, from its own errors, (time, marker, axis, axis); None where not known.
        response: to errors of standard deviation 1 that all share, (time, marker, axis, error), m.

    Returns:
        position (time, body, axis), m, and in a plane or space `orientation` (time, body, quaternion) where there is a body
        with enough markers; NaN where too few are visible. If the covariance is known, `position_std` (time, body, axis)
        and `orientation_std` (time, body), rad, the root mean square of the angle by which the orientation is off. The
        attribute `unknown` names the bodies whose turning the markers do not tell; these are taken not to turn.
    """
    axes = instrument["axis"].values.tolist()
    carriers = instrument["marker_body"].values
    points = instrument["marker_point"].transpose("marker", "axis").values.astype(float)
    bodies = list(dict.fromkeys(carriers.tolist()))
    information = _inverse(covariance) if covariance is not None else np.broadcast_to(np.eye(len(axes)), _square(positions))
    rows = [np.flatnonzero(carriers == body) for body in bodies]
    poses = [fit_pose(points[of], positions[:, of], information[:, of], response[:, of], axes) for of in rows]
    variables = {"position": _variable([pose.position for pose in poses], "axis", "m")}
    turning = any(pose.turns.size for pose in poses)
    if turning:
        variables["orientation"] = _variable([_quaternion(pose) for pose in poses], "quaternion", "1")
    if covariance is not None:
        variables["position_std"] = _variable([_position_std(pose) for pose in poses], "axis", "m")
    if covariance is not None and turning:
        angles = np.stack([_angle_std(pose) for pose in poses], axis=1)
        variables["orientation_std"] = xr.Variable(("time", "body"), angles, {"units": "rad"})
    coordinates = {"time": instrument["time"], "body": bodies, "axis": axes}
    if turning:
        coordinates["quaternion"] = ["w", "x", "y", "z"]
    return xr.Dataset(variables, coordinates, {"unknown": "; ".join(_unknown(bodies, poses, axes))})


def _variable(by_body: Sequence[np.ndarray], dim: str, units: str) -> xr.Variable:
    return xr.Variable(("time", "body", dim), np.stack(by_body, axis=1), {"units": units})


def _square(positions: np.ndarray) -> tuple[int, ...]:
    return (*positions.shape, positions.shape[-1])


def _inverse(covariance: np.ndarray) -> np.ndarray:
    known = np.isfinite(covariance).all(axis=(2, 3), keepdims=True)
    return np.linalg.inv(np.where(known, covariance, np.eye(covariance.shape[-1])))


def _position_std(pose: Pose) -> np.ndarray:
    return np.asarray(np.sqrt(np.diagonal(pose.covariance, axis1=1, axis2=2)[:, : pose.position.shape[1]]))


def _angle_std(pose: Pose) -> np.ndarray:
    turns = pose.covariance[:, pose.position.shape[1] :, pose.position.shape[1] :]
    return np.asarray(np.sqrt(np.trace(turns, axis1=1, axis2=2))) + (0.0 if pose.turns.size else np.nan)


def _quaternion(pose: Pose) -> np.ndarray:
    """(w, x, y, z), (time, 4), without jumps from q to -q; NaN where the rotation is not known."""
    known = np.isfinite(pose.rotation).all(axis=(1, 2)) & (pose.turns.size > 0)
    quaternion = np.full((len(known), 4), np.nan)
    if known.any():
        found = np.roll(Rotation.from_matrix(pose.rotation[known]).as_quat(canonical=True), 1, axis=1)
        jumps = np.where((found[1:] * found[:-1]).sum(axis=1) < 0.0, -1.0, 1.0)
        quaternion[known] = found * np.concatenate([[1.0], np.cumprod(jumps)])[:, None]
    return quaternion


def _unknown(bodies: Sequence[str], poses: Sequence[Pose], axes: Sequence[str]) -> list[str]:
    if len(axes) == 1:
        return []
    return [
        f"{body}: its turning ({NEEDED[len(axes)]} would tell it)"
        for body, pose in zip(bodies, poses, strict=True)
        if not pose.turns.size
    ]
