"""Several accelerometers on one rigid body: what they see of its motion together, and what they cannot."""

import numpy as np
import xarray as xr
from attrs import frozen

from crashkit_accelerometers.error_specs import AXES
from crashkit_accelerometers.rotations import cross_matrix

BLIND = 1e-6
"""A combination of motions is unseen if it moves the sensors by less than this share of the one that moves them most."""


@frozen(eq=False)
class SensorArray:
    """The sensors of one body.

    Attributes:
        body: its name.
        sensors: their names.
        points: in the body's axes, from its centre of mass, m, (sensor, 3).
        std: of a sample as recorded, m s-2, (sensor,); 1 where it is not known.
        recorded: which of x, y and z they record, as indices.
        turning: False where the body is taken not to turn.
    """

    body: str
    sensors: tuple[str, ...]
    points: np.ndarray
    std: np.ndarray
    recorded: tuple[int, ...]
    turning: bool = True

    @property
    def centre(self) -> np.ndarray:
        """The barycentre, in which acceleration and angular acceleration are known independently, m, (3,)."""
        return np.asarray(np.average(self.points, axis=0, weights=self.std**-2))

    @property
    def arms(self) -> np.ndarray:
        """The points from the barycentre, (sensor, 3)."""
        return self.points - self.centre

    @property
    def rotations(self) -> np.ndarray:
        """The axes that the body can turn about: all in space, the normal in the plane, none on a line, (rotation, 3)."""
        across = [axis for axis in range(3) if axis not in self.recorded]
        choices: dict[int, list[int]] = {3: [0, 1, 2], 2: across, 1: []}
        return np.eye(3)[choices[len(self.recorded)] if self.turning else []]

    @property
    def push_covariance(self) -> np.ndarray:
        """Of the acceleration of the barycentre that one sample tells, m2 s-4, (3, 3)."""
        return np.diag(np.isin(range(3), self.recorded) / np.sum(self.std**-2))

    @property
    def design(self) -> np.ndarray:
        """Readings, over their standard deviations, of unit accelerations and angular accelerations, (reading, unknown)."""
        pushes = np.broadcast_to(np.eye(3)[:, list(self.recorded)], (len(self.sensors), 3, len(self.recorded)))
        turns = -cross_matrix(self.arms) @ self.rotations.T
        both = np.concatenate([pushes, turns], axis=-1)[:, list(self.recorded)] / self.std[:, None, None]
        return both.reshape(-1, both.shape[-1])

    @property
    def second_moment(self) -> np.ndarray:
        """M = sum (|d|^2 - d d') / std^2, an inertia of the array: M alpha = sum d x f / std^2 - omega x M omega."""
        arms = self.arms / self.std[:, None]
        return np.asarray(np.sum(arms**2) * np.eye(3) - arms.T @ arms)

    @property
    def angular_covariance(self) -> np.ndarray:
        """Of the angular acceleration that one sample tells, rad2 s-4, (3, 3); 0 about axes that no body turns about."""
        turns = self.rotations
        return turns.T @ np.linalg.inv(turns @ self.second_moment @ turns.T) @ turns

    @property
    def redundant(self) -> np.ndarray:
        """Combinations of weighted readings that no acceleration or angular acceleration changes, (combination, reading)."""
        design = self.design
        return np.linalg.svd(design)[0][:, np.linalg.matrix_rank(design, BLIND) :].T

    def unseen(self) -> list[str]:
        """A phrase for every combination of motions that moves no sensor; empty where the array tells all."""
        _, sizes, combinations = np.linalg.svd(self.design)
        blind = combinations[np.sum(sizes > BLIND * sizes[0]) :]
        return list(dict.fromkeys(self._phrase(row[len(self.recorded) :] @ self.rotations) for row in blind))

    def _phrase(self, turn: np.ndarray) -> str:
        if np.ptp(self.points, axis=0).max() == 0.0:
            return f"rotation about {' and '.join(self.sensors)}, in any direction"
        x, y, z = turn / np.linalg.norm(turn) * np.sign(turn[np.argmax(np.abs(turn))])
        return f"rotation about the line through {' and '.join(self.sensors)}, ({x:z.2f}, {y:z.2f}, {z:z.2f})"


def sensor_arrays(instrument: xr.Dataset, turning: bool) -> list[SensorArray]:
    """The sensors of an accelerometer group, body by body."""
    carriers = instrument["sensor_body"].values.astype(str)
    recorded = tuple(AXES.index(str(axis)) for axis in instrument["axis"].values)
    points = np.zeros((len(carriers), 3))
    points[:, list(recorded)] = instrument["sensor_point"].transpose("sensor", "axis").values
    std = instrument["acceleration_std"].values if "acceleration_std" in instrument else np.ones(len(carriers))
    names = instrument["sensor"].values.astype(str)
    arrays = []
    for body in dict.fromkeys(carriers.tolist()):
        here = carriers == body
        arrays.append(SensorArray(body, tuple(names[here].tolist()), points[here], std[here], recorded, turning))
    return arrays
