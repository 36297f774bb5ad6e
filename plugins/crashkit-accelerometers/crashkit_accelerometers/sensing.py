"""The directions in which a sensor's channels sense."""

from functools import cache

import numpy as np

from crashkit_accelerometers.chain import Own, acts
from crashkit_accelerometers.error_specs import AXES
from crashkit_accelerometers.rotations import cross_matrix, left_jacobian, turned

Directions = tuple[np.ndarray, dict[str, np.ndarray]]
TILT, TRANSVERSE = ([f"{kind}_{axis}" for axis in AXES] for kind in ("tilt", "transverse"))


def directions(own: Own, channels: tuple[str, ...], axes: tuple[str, ...]) -> Directions:
    """What each channel takes of each axis, and the derivatives of that to its errors.

    The row of the channel along the axis e is R(tilt) e + transverse, without the part of `transverse` along e.

    Arguments:
        own: `tilt_<axis>` and `transverse_<axis>`, (sensor, channel).
        channels: the axis of each channel.
        axes: that are felt; a sensor of a model in one axis feels nothing across it.

    Returns:
        (sensor, channel, axis) and, by the name of the error, its derivatives in the same shape where they are not 0.
    """
    if not acts(own, *TILT, *TRANSVERSE):
        return _aligned(len(own["gain"]), channels, axes)
    tilt, transverse = (np.stack([own[name] for name in names], axis=-1) for names in (TILT, TRANSVERSE))
    return _directions(tilt, transverse, channels, axes)


@cache
def _aligned(sensors: int, channels: tuple[str, ...], axes: tuple[str, ...]) -> Directions:
    """Of sensors without these errors: asked for in every prediction."""
    none = np.zeros((sensors, len(channels), len(AXES)))
    return _directions(none, none, channels, axes)


def _directions(tilt: np.ndarray, transverse: np.ndarray, channels: tuple[str, ...], axes: tuple[str, ...]) -> Directions:
    base = np.eye(3)[[AXES.index(axis) for axis in channels]]
    rows = np.einsum("scij,cj->sci", turned(tilt), base)
    by_tilt = -cross_matrix(rows) @ left_jacobian(tilt)
    changes = {f"tilt_{axis}": by_tilt[..., index] for index, axis in enumerate(AXES)}
    across = np.broadcast_to(1.0 - base, tilt.shape)
    changes |= {f"transverse_{axis}": across * np.eye(3)[index] for index, axis in enumerate(AXES)}
    felt = [AXES.index(axis) for axis in axes]
    known = {name: np.ascontiguousarray(change[..., felt]) for name, change in changes.items() if change[..., felt].any()}
    return np.ascontiguousarray((rows + across * transverse)[..., felt]), known
