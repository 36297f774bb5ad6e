"""How large a secret is: what it changes in the recordings, and what of that the model's own parameters cannot take up."""

import numpy as np
from attrs import frozen

from crashkit.testing.concealed.given import free_parameters, tuned
from crashkit.testing.concealed.scene import Scene

SIZES = {"small": (8.0, 40.0), "middle": (40.0, 250.0), "gross": (250.0, 5000.0)}
"""Standard deviations that a secret leaves over all runs that are fitted, once the model is tuned; 6 is a matter of luck."""

_CHANGE = 0.01
_COARSE = 3e-5
"""s, the step for sizes, which need no more than two digits."""
_FREEDOM = 0.5
"""Standard deviation of the logarithm of a parameter: how far a tuning would go."""


def named(sigmas: float) -> str:
    """The size that so many standard deviations are."""
    return next((name for name, (_, most) in SIZES.items() if sigmas <= most), "gross")


def samples(scene: Scene) -> np.ndarray:
    """Every noise-free sample of the runs that are fitted, in units of noise."""
    return scene.signals(scene.motions(step=_COARSE))


@frozen
class Tuning:
    """The given model at the true values: its samples, and how each free parameter moves them.

    Arguments:
        scene: without secrets.
        base: (sample,) in units of noise.
        jacobian: (sample, parameter) by the parameters' logarithms.
    """

    scene: Scene
    base: np.ndarray
    jacobian: np.ndarray

    @classmethod
    def of(cls, scene: Scene) -> "Tuning":
        """By differences of one per cent in every free parameter."""
        base = samples(scene)
        columns = []
        for index, _ in enumerate(free_parameters(scene)):
            change = np.zeros(index + 1)
            change[index] = _CHANGE
            columns.append((samples(tuned(scene, change)) - base) / _CHANGE)
        return cls(scene, base, np.stack(columns, 1))

    def left(self, changed: np.ndarray, rounds: int = 2) -> float:
        """What of a difference from the base remains after tuning, in standard deviations."""
        j = self.jacobian
        solve = np.linalg.solve(j.T @ j + np.eye(j.shape[1]) / _FREEDOM**2, j.T)
        change, residual = np.zeros(j.shape[1]), changed - self.base
        best = float(np.linalg.norm(residual))
        for _ in range(rounds):
            change = np.clip(change + solve @ residual, -1.0, 1.0)
            residual = changed - samples(tuned(self.scene, change))
            best = min(best, float(np.linalg.norm(residual)))
        return best

    def left_beside(self, changed: np.ndarray, others: list[np.ndarray]) -> float:
        """The same, to first order, if the differences of other secrets can be taken up too."""
        j = np.column_stack([self.jacobian, *(other - self.base for other in others)])
        difference = changed - self.base
        return float(np.linalg.norm(difference - j @ np.linalg.lstsq(j, difference, rcond=None)[0]))
