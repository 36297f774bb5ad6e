"""A force curve of any number of points, as a test machine records it."""

import numpy as np
from numpy.typing import NDArray

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, UNLOADING_STIFFNESS

Points = NDArray[np.float64]

RISE = 1e-4
"""m, over which a force given at deformation 0 is reached."""


class MeasuredCurve(SpringLaw):
    """The broken line from (0, 0) through the points (deformation[i], force[i]), whose last segment goes on for ever.

    With x = d - clearance: F = max(0, F_load(d_max) - k (d_max - d)), and F_load(d) instead without unloading stiffness k.

    The same as `piecewise_affine`, for so many points that a branch for each would take long to compile: the segment is
    looked up. The points are measured, and so they are not free to be identified.
    """

    name = "measured_curve"
    parameters = (
        ParameterSpec(
            "deformation", "m", "deformation at the points, increasing", lower=0.0, free=False, vector=True, increasing=True
        ),
        ParameterSpec("force", "N", "force at the points", free=False, vector=True),
        UNLOADING_STIFFNESS,
        CLEARANCE,
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        deformation: Points,
        force: Points,
        unloading_stiffness: float,
        clearance: float,
    ) -> float:
        """The force, N, compression positive."""
        branch = MeasuredCurve.branch(d, ddot, d_max, deformation, force, unloading_stiffness, clearance)
        return MeasuredCurve.branch_force(branch, d, ddot, d_max, deformation, force, unloading_stiffness, clearance)[0]

    @staticmethod
    def branch(
        d: float,
        ddot: float,
        d_max: float,
        deformation: Points,
        force: Points,
        unloading_stiffness: float,
        clearance: float,
    ) -> int:
        """Twice the number of the segment, 0 before the first; one more where the force has vanished."""
        turn = d_max if unloading_stiffness > 0.0 else d
        x, low, high = turn - clearance, 0, len(force)
        if x <= 0.0:
            return 1
        while high - low > 1:
            middle = (low + high) // 2
            if x >= _point(deformation, force, middle)[0]:
                low = middle
            else:
                high = middle
        return 2 * high + (_static(2 * high, d, turn, deformation, force, unloading_stiffness, clearance) <= 0.0)

    @staticmethod
    def branch_force(
        branch: int,
        d: float,
        ddot: float,
        d_max: float,
        deformation: Points,
        force: Points,
        unloading_stiffness: float,
        clearance: float,
    ) -> tuple[float, float]:
        """The force, N, and the distance to the end of the branch."""
        turn = d_max if unloading_stiffness > 0.0 else d
        x = turn - clearance
        if branch == 1:
            return 0.0, -x
        segment, vanished = branch // 2, branch % 2
        distance = x - _point(deformation, force, segment - 1)[0]
        if segment < len(force):
            distance = min(distance, _point(deformation, force, segment)[0] - x)
        static = _static(branch, d, turn, deformation, force, unloading_stiffness, clearance)
        return (0.0, min(distance, -static)) if vanished else (static, min(distance, static))

    @staticmethod
    def branch_slopes(
        branch: int,
        d: float,
        ddot: float,
        d_max: float,
        deformation: Points,
        force: Points,
        unloading_stiffness: float,
        clearance: float,
        slopes: Points,
    ) -> None:
        """Derivatives of the force to d, ddot, d_max and every number of the parameters."""
        slopes[:] = 0.0
        if branch % 2 == 1:
            return
        count, segment = len(force), branch // 2
        turn = d_max if unloading_stiffness > 0.0 else d
        (x0, f0), (x1, f1) = _point(deformation, force, segment - 1), _point(deformation, force, segment)
        slope, share = (f1 - f0) / (x1 - x0), (turn - clearance - x0) / (x1 - x0)
        slopes[0] = slope
        if unloading_stiffness > 0.0:
            slopes[0] = unloading_stiffness
            slopes[2] = slope - unloading_stiffness
        for point, part in ((segment - 2, 1.0 - share), (segment - 1, share)):
            if point >= 0:
                slopes[3 + count + point] = part
                if deformation[point] > RISE:
                    slopes[3 + point] = -slope * part
        slopes[3 + 2 * count] = d - turn
        slopes[4 + 2 * count] = -slope


def _point(deformation: Points, force: Points, number: int) -> tuple[float, float]:
    """A corner of the curve: number 0 is (0, 0), the others are the points."""
    if number == 0:
        return 0.0, 0.0
    return max(RISE, deformation[number - 1]), force[number - 1]


def _static(
    branch: int, d: float, turn: float, deformation: Points, force: Points, unloading_stiffness: float, clearance: float
) -> float:
    """The force on the segment of a branch, before it vanishes."""
    x0, f0 = _point(deformation, force, branch // 2 - 1)
    x1, f1 = _point(deformation, force, branch // 2)
    return f0 + (f1 - f0) * (turn - clearance - x0) / (x1 - x0) - unloading_stiffness * (turn - d)
