"""What earlier frames tell of the light on a target: a gradient looks much like a shift of a blurred edge."""

import numpy as np
from attrs import define, evolve
from scipy.stats import chi2

from crashkit_cameras.tracking.fit import Fit

FADING = 1.1
"""By how much the covariance of what is remembered grows from one frame to the next."""
CHANGED = float(chi2.isf(1e-3, 4))
"""Squared deviations from what is remembered, from which on the light has changed."""

TINY = 1e-9


@define
class Light:
    """The gradients of ground and contrast, (4,), and their covariance; none before the first frame."""

    gradients: np.ndarray | None = None
    covariance: np.ndarray | None = None

    def applied(self, found: Fit) -> Fit:
        """A fit moved to where it is if the light is as before, and remembered: Kalman's step.

        x' = x + C G^-1 (g0 - g), with g the fit's gradients and g0 those remembered, G the sum of both covariances and C
        the covariance of the fit's values x with g.
        """
        joint, state = found.covariance, np.append(found.centre, found.gradients)
        if self.gradients is not None and self.covariance is not None:
            spread, surprise = joint[2:, 2:] + FADING * self.covariance, self.gradients - found.gradients
            spread += (TINY * np.trace(spread) + np.finfo(float).tiny) * np.eye(4)
            if surprise @ np.linalg.solve(spread, surprise) < CHANGED:
                gain = np.linalg.solve(spread, joint[2:]).T
                state, joint = state + gain @ surprise, joint - gain @ joint[2:]
        self.gradients, self.covariance = state[2:], joint[2:, 2:]
        return evolve(found, shape=np.append(state[:2], found.shape[2:]), covariance=joint)
