"""How large a secret is: what it changes in the recordings, and what of that the model's own parameters cannot take up."""

from collections.abc import Callable, Sequence

import numpy as np
from attrs import frozen
from scipy.optimize import least_squares

from crashkit.testing.concealed.given import free_parameters, tuned
from crashkit.testing.concealed.scene import Scene

SIZES = {"small": (8.0, 40.0), "middle": (40.0, 250.0), "gross": (250.0, 5000.0)}
"""Standard deviations that a secret leaves over all runs that are fitted, once the model is tuned; 6 is a matter of luck."""
HIDDEN = "hidden"
"""The size of what leaves less than any of these: the model's own parameters take it up."""

_CHANGE = 0.01
_COARSE = 3e-5
"""s, the step for sizes, which need no more than two digits."""
_FREEDOM = 0.5
"""Standard deviation of the logarithm of a parameter: how far a tuning would go."""
_FURTHEST = 1.0
"""The same, at most."""
_ROUNDS = 12
"""Of a fit, at most."""
_DIGITS = 1e-3
"""Share of the sum of squares by which a round must improve it."""


def named(sigmas: float) -> str:
    """The size that so many standard deviations are."""
    if sigmas < SIZES["small"][0]:
        return HIDDEN
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
        """About what of a difference from the base remains after tuning, in standard deviations: quick, rather too much."""
        j = self.jacobian
        solve = np.linalg.solve(j.T @ j + np.eye(j.shape[1]) / _FREEDOM**2, j.T)
        change, residual = np.zeros(j.shape[1]), changed - self.base
        best = float(np.linalg.norm(residual))
        for _ in range(rounds):
            change = np.clip(change + solve @ residual, -_FURTHEST, _FURTHEST)
            residual = changed - samples(tuned(self.scene, change))
            best = min(best, float(np.linalg.norm(residual)))
        return best

    def left_beside(self, changed: np.ndarray, others: list[np.ndarray]) -> float:
        """The same, to first order, if the differences of other secrets can be taken up too."""
        j = np.column_stack([self.jacobian, *(other - self.base for other in others)])
        difference = changed - self.base
        return float(np.linalg.norm(difference - j @ np.linalg.lstsq(j, difference, rcond=None)[0]))


def left_when_fitted(scene: Scene, others: Sequence[Callable[[Scene, float], Scene]], recorded: np.ndarray) -> float:
    """What a model that lacks one secret leaves of what is recorded, in standard deviations, once it is fitted to that.

    min |samples(x) - recorded|^2 + |x|^2 / freedom^2 over the logarithms x of all free parameters and of other strengths.

    Arguments:
        scene: without secrets.
        others: the secrets that the model does not lack: what puts each into a scene, at a factor of its strength.
        recorded: (sample,) in units of noise.
    """
    count = len(list(free_parameters(scene)))

    def left(x: np.ndarray) -> np.ndarray:
        told = tuned(scene, x[:count])
        for into, factor in zip(others, np.exp(x[count:]), strict=True):
            told = into(told, float(factor))
        return samples(told) - recorded

    def residual(x: np.ndarray) -> np.ndarray:
        return np.concatenate([left(x), x / _FREEDOM])

    def slopes(x: np.ndarray) -> np.ndarray:
        here, steps = left(x), _CHANGE * np.eye(len(x))
        return np.vstack([np.stack([(left(x + step) - here) / _CHANGE for step in steps], 1), np.eye(len(x)) / _FREEDOM])

    start = np.zeros(count + len(others))
    fit = least_squares(residual, start, slopes, (-_FURTHEST, _FURTHEST), max_nfev=_ROUNDS, ftol=_DIGITS)
    return float(np.linalg.norm(left(fit.x)))
