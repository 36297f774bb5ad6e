"""How much of a secret stays visible after the public parameters have been tuned: an estimate, in standard deviations."""

import numpy as np
from attrs import frozen

from crashkit.testing.concealed.sensors import read
from crashkit.testing.concealed.vehicle import PUBLIC, Scene
from crashkit.testing.concealed.world import Trace, run

TAIL = 0.04  # s followed beyond the recording, for filters and clocks
_STEP = 0.01
_FREEDOM = 0.5  # standard deviation of the logarithm of a public parameter: how far a tuning would go


def traces(scene: Scene, runs: slice = slice(0, 3)) -> list[Trace]:
    """The true motion of the chosen runs."""
    return [run(scene.world, speed, scene.duration + TAIL) for speed in scene.speeds[runs]]


def signals(scene: Scene) -> np.ndarray:
    """Every noise-free sample of the three runs in units of the unfiltered noise.

    A filter passes the same share of a slow signal's and of the noise's independent samples, so a sum of squares of
    these counts independent samples only.
    """
    columns = [
        read(instrument, sensor, trace, scene.duration, None) / sensor.noise
        for trace in traces(scene)
        for instrument in scene.instruments.values()
        for sensor in instrument.sensors.values()
    ]
    return np.concatenate(columns)


@frozen
class Tuning:
    """The public model at its true values: its signals and how each parameter moves them."""

    scene: Scene
    base: np.ndarray
    paths: list[tuple[str, str]]
    jacobian: np.ndarray

    @classmethod
    def of(cls, scene: Scene) -> "Tuning":
        """Differences of one per cent in every public parameter."""
        base = signals(scene)
        paths = [(joint, name) for joint in scene.public_joints for name in PUBLIC if name in scene.world.joints[joint].fields]
        columns = [(signals(_tuned(scene, [path], [_STEP])) - base) / _STEP for path in paths]
        return cls(scene, base, paths, np.stack(columns, 1))

    def left(self, target: np.ndarray, rounds: int = 2, beside: np.ndarray | None = None) -> float:
        """The misfit to `target` that tuning leaves, in standard deviations; `beside`: directions that may be used too."""
        jacobian = self.jacobian if beside is None else np.column_stack([self.jacobian, beside])
        solve = np.linalg.inv(jacobian.T @ jacobian + np.eye(jacobian.shape[1]) / _FREEDOM**2) @ jacobian.T
        change, residual = np.zeros(len(self.paths)), target - self.base
        best = np.linalg.norm(residual)
        for _ in range(rounds if beside is None else 0):
            change = np.clip(change + (solve @ residual)[: len(self.paths)], -1.0, 1.0)
            residual = target - signals(_tuned(self.scene, self.paths, change))
            best = min(best, np.linalg.norm(residual))
        linear = np.linalg.norm(target - self.base - jacobian @ (solve @ (target - self.base)))
        return float(linear if beside is not None else best)


def _tuned(scene: Scene, paths: list[tuple[str, str]], change: np.ndarray | list[float]) -> Scene:
    scene = scene.copy()
    for (joint, name), logarithm in zip(paths, change, strict=True):
        scene.world.joints[joint].fields[name] *= float(np.exp(logarithm))
    return scene
