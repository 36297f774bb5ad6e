"""How well the fitted runs foretell the held-out ones, whatever is right or wrong about the model."""

import math

import numpy as np

from crashkit.errors import SimulationError
from crashkit.misfit import Misfit


def expected_error(final: Misfit, unseen: Misfit, believed: float) -> tuple[float, str]:
    """The residual over noise that the right model would leave in runs that it was not fitted to, and the number to blame.

        sqrt(1 + trace(J C J^T) / n),   C = (J_f^T J_f)^-1

    with J and J_f the derivatives of the weighted residuals of the held-out and the fitted runs to the numbers, and n the
    independent samples held out (Seber and Wild 1989, https://doi.org/10.1002/0471725315). A number without effect where it
    stands may be a threshold just ahead: of it J has the larger of the secants over one deviation. To blame is the number
    that, were it known, would lessen the trace most. Not a number where the derivatives cannot be had.

    Arguments:
        final: what was fitted, at its best fit.
        unseen: the same model in the held-out runs.
        believed: relative deviation to which a number is known that the fitted runs do not see.
    """
    if not unseen.names:
        return 1.0, ""
    fitted, start = final.with_prior(believed), unseen.start()
    try:
        known = fitted.residual_and_jacobian(fitted.start())[1]
        jacobian = unseen.residual_and_jacobian(start)[1][: len(unseen.discrepancy(start))]
        if not np.isfinite(known).all() or not np.isfinite(jacobian).all():
            return math.nan, ""
        root = np.linalg.pinv(np.linalg.qr(known, mode="r"))
        deviations = np.linalg.norm(root, axis=1)
        for index in np.flatnonzero(~jacobian.any(axis=0) & (deviations > 0.0)):
            jacobian[:, index] = _secant(unseen, start, int(index), float(deviations[index]))
    except SimulationError:
        return math.nan, ""
    spread = jacobian @ root
    saved = np.sum((spread @ root.T) ** 2, axis=0) / np.maximum(np.sum(root**2, axis=1), np.finfo(float).tiny)
    return float(np.sqrt(1.0 + np.sum(spread**2) / unseen.independent_samples)), unseen.names[int(np.argmax(saved))]


def _secant(unseen: Misfit, start: np.ndarray, index: int, deviation: float) -> np.ndarray:
    """The larger change of the discrepancy with one number, up or down by its deviation, per unit."""
    here, aside = unseen.discrepancy(start), deviation * np.eye(len(start))[index]
    changes = [(unseen.discrepancy(start + move) - here) / deviation for move in (-aside, aside)]
    return max(changes, key=lambda change: float(change @ change))
