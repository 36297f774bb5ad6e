"""Sums of squares about a point; those of a larger model from what is known of a smaller one."""

from collections.abc import Sequence

import numpy as np
from attrs import frozen

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit

ALIKE = 0.03
"""Units of noise within which two simulations are the same: one that meets a corner more is off by less."""


@frozen(eq=False)
class Quadratic:
    """|r + J u|² = |r|² + 2 g·u + u·C u, with g = Jᵀr and C = JᵀJ.

    Attributes:
        value, gradient, curvature: |r|², g and C.
    """

    value: float
    gradient: np.ndarray
    curvature: np.ndarray

    def after(self, step: np.ndarray) -> float:
        """The sum of squares after a step."""
        return float(self.value + step @ (2.0 * self.gradient + self.curvature @ step))


@frozen(eq=False)
class Tangent:
    """Residuals r and their derivatives J at a point, and their sum of squares about it.

    Attributes:
        names: of the parameters.
        samples: how many residuals are of samples; the others are of what is known of parameters beforehand.
    """

    names: tuple[str, ...]
    residual: np.ndarray
    jacobian: np.ndarray
    samples: int
    square: Quadratic


def tangent(misfit: Misfit, point: np.ndarray) -> Tangent | None:
    """From a simulation; None where that fails or blows up."""
    try:
        residual, jacobian = misfit.residual_and_jacobian(point)
    except SimulationError:
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        square = Quadratic(float(residual @ residual), jacobian.T @ residual, jacobian.T @ jacobian)
    if not (np.isfinite(square.value) and np.isfinite(square.curvature).all()):
        return None
    return Tangent(misfit.names, residual, jacobian, misfit.sample_count, square)


class Extended:
    """The sum of squares of a model with new parameters, about points at which all its own have one and the same values.

    Where it moves as without them, the derivatives to its own are known already, and only those to the new are simulated.

    Arguments:
        misfit: of the model with them.
        new: their paths.
        known: of the model without them, at the same values; None where that is not known.
    """

    def __init__(self, misfit: Misfit, new: Sequence[str], known: Tangent | None = None) -> None:
        self.misfit = misfit
        own = [name for name in misfit.names if name not in new]
        self._known = known if known and set(own) == set(known.names) else None
        self._held = misfit.with_values({}, dict.fromkeys(own, False))

    def at(self, point: np.ndarray, is_absent: bool) -> Quadratic | None:
        """About a point, at which what is new may be absent; None where that cannot be simulated."""
        joined = self._joined(self._known, point) if is_absent and self._known else None
        if joined is not None:
            return joined
        whole = tangent(self.misfit, point)
        return None if whole is None else whole.square

    def _joined(self, known: Tangent, point: np.ndarray) -> Quadratic | None:
        beside = tangent(self._held, self._held.start_at(self.misfit.values(point)))
        samples = slice(known.samples)
        if beside is None or np.abs(beside.residual[samples] - known.residual[samples]).max(initial=0.0) > ALIKE:
            return None
        mixed = known.jacobian[samples].T @ beside.jacobian[samples]
        curvature = np.block([[known.square.curvature, mixed], [mixed.T, beside.square.curvature]])
        gradient = np.concatenate([known.square.gradient, beside.square.gradient])
        names = (*known.names, *beside.names)
        order = [names.index(name) for name in self.misfit.names]
        value = known.square.value + float(np.sum(beside.residual[known.samples :] ** 2))
        return Quadratic(value, gradient[order], curvature[np.ix_(order, order)])
