"""The misfit about a point as the parabola that its derivatives make of it: how far the bottom is, and how wide."""

from functools import cached_property

import numpy as np
from attrs import evolve, frozen

from crashkit.misfit import Misfit
from crashkit.misfit.bands import CONFIDENCE
from crashkit.protocols import Problem
from crashkit_identifiers.cost import NOTHING, cost_at
from crashkit_identifiers.normal_equations import normal_equations

FAR = 25.0
"""χ² between a point and the least misfit, beyond which the curvature there says nothing about the bottom."""
UNDETERMINED = 1e-10
"""Share of the largest curvature below which the misfit does not say where to go."""
NO_INFORMATION = 1e-14
"""Curvature, of parameters scaled to 1, that counts as none."""


@frozen(eq=False)
class Parabola:
    """½ |r|² and its derivatives at a point, in search variables; with J those of r, gradient Jᵀr and curvature H = JᵀJ.

    Arguments:
        point: in search variables.
        cost, gradient, curvature: there.
        count: of residuals, as many as they amount to independently.
        held: (parameter,) which of them a bound holds.
    """

    point: np.ndarray
    cost: float
    gradient: np.ndarray
    curvature: np.ndarray
    count: float
    held: np.ndarray

    @property
    def normalised(self) -> float:
        """Root mean square of the residuals over their noise."""
        return float(np.sqrt(2.0 * self.cost / max(self.count, 1.0)))

    @property
    def excess(self) -> float:
        """χ² over its expectation, where that is more than chance allows; else 1."""
        freedom = max(self.count - len(self.point), 1.0)
        ratio = 2.0 * self.cost / freedom
        return ratio if ratio > 1.0 + 3.0 * np.sqrt(2.0 / freedom) else 1.0

    @property
    def rise(self) -> float:
        """Of the cost that marks the end of a 95 % interval."""
        return 0.5 * CONFIDENCE**2 * self.excess

    @cached_property
    def left(self) -> np.ndarray:
        """Δ, the Gauss-Newton step that the misfit would still take, in the directions in which it says where to go."""
        step, felt = np.zeros(len(self.point)), self._felt
        root, eigenvalues, vectors = modes(self.curvature[np.ix_(felt, felt)])
        seen = eigenvalues > UNDETERMINED * eigenvalues.max(initial=0.0)
        downhill = vectors[:, seen].T @ (self.gradient[felt] / root)
        step[felt] = -(vectors[:, seen] @ (downhill / eigenvalues[seen])) / root
        return step

    @property
    def drop(self) -> float:
        """Of the cost along `left`, ½ Δᵀ H Δ."""
        return 0.5 * float(self.left @ self.curvature @ self.left)

    @property
    def is_far(self) -> bool:
        """Whether the point is too far from the least misfit for its curvature to tell anything."""
        return 2.0 * self.drop > FAR * self.excess

    @cached_property
    def spread(self) -> np.ndarray:
        """Covariance of the search variables, H⁻¹ `excess`; infinite where nothing is felt, 0 where a bound holds."""
        felt = self._felt
        root, eigenvalues, vectors = modes(self.curvature[np.ix_(felt, felt)])
        inverse = np.zeros_like(self.curvature)
        np.fill_diagonal(inverse, np.where(self.held, 0.0, np.inf))
        inverse[np.ix_(felt, felt)] = vectors / np.maximum(eigenvalues, NO_INFORMATION) @ vectors.T / np.outer(root, root)
        return self.excess * inverse

    def reach(self) -> np.ndarray:
        """Half the width of every linear interval about the least misfit, so that the point lies inside."""
        return np.sqrt(np.diag(self.spread) * (CONFIDENCE**2 + 2.0 * self.drop / self.excess))

    @cached_property
    def alone(self) -> np.ndarray:
        """Half the width of every interval if the other variables were known; infinite where nothing is felt."""
        with np.errstate(divide="ignore"):
            return CONFIDENCE * np.sqrt(self.excess / np.diag(self.curvature))

    def expected(self, index: int, value: float) -> float:
        """How far the cost should rise where one variable has that value, the others being at their best."""
        away = value - self.point[index] - self.left[index]
        return float(away**2 / (2.0 * self.spread[index, index]) * self.excess - self.drop)

    @property
    def _felt(self) -> np.ndarray:
        """Numbers of the variables that the misfit depends on and that no bound holds."""
        return np.flatnonzero(~self.held & (np.diag(self.curvature) > 0.0))


def modes(curvature: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Square roots of the diagonal, and the eigenvalues and vectors of a curvature when the diagonal is scaled to 1."""
    root = np.sqrt(np.diag(curvature))
    eigenvalues, vectors = np.linalg.eigh(curvature / np.outer(root, root))
    return root, eigenvalues, vectors


def parabola_at(problem: Problem, objective: Problem, point: np.ndarray, count: float | None = None) -> Parabola | None:
    """The misfit about a point; None where the model cannot be simulated.

    Arguments:
        problem: whose readings are counted, and whose bounds hold.
        objective: whose residuals are meant: those of a prior may have joined them, outliers may have left.
        point: in search variables.
        count: of independent readings, if these are not all of the problem's.
    """
    there = normal_equations(objective, point)
    if there is None:
        return None
    residual, gradient, curvature = there
    cost = 0.5 * float(residual @ residual)
    if count is None:
        count = problem.independent_samples if isinstance(problem, Misfit) else float(len(residual))
    lower, upper = problem.bounds()
    found = Parabola(point, cost, gradient, curvature, count, (point <= lower) | (point >= upper))
    return found if found.is_far or _keeps_its_promise(objective, found) else evolve(found, gradient=np.zeros_like(gradient))


def _keeps_its_promise(objective: Problem, found: Parabola) -> bool:
    """Whether the misfit falls along the way left: at a bottom that a threshold kinks, derivatives promise in vain."""
    there = np.clip(found.point + found.left, *objective.bounds())
    return found.drop < NOTHING or found.cost - cost_at(objective, there) > 0.5 * found.drop
