"""A force curve given by its corners."""

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, RATE_COEFFICIENT, TENSION, UNLOADING_STIFFNESS


class PiecewiseAffine(SpringLaw):
    """A succession of affine segments (Mizzi & Jezequel 1992, Fig 2).

    With x = d - clearance, F_load is the broken line from (0, 0) through (deformation[i], force[i]), then `final_stiffness`; a
    force given at deformation 0 replaces the origin, and then the law starts with that preload.
    F = max(0, F_load(d_max) - k (d_max - d)) max(0, 1 + a ddot); without unloading stiffness k, F_load(d) in place of the first.

    Below x = 0 the first segment goes on, so that a preload falls off along it; with `tension` it and the unloading line pull.
    """

    name = "piecewise_affine"
    parameters = (
        ParameterSpec("deformation", "m", "deformation at the corners, increasing", lower=0.0, free=False, vector=True),
        ParameterSpec("force", "N", "force at the corners", vector=True),
        ParameterSpec("final_stiffness", "N m-1", "slope after the last corner", default=0.0),
        UNLOADING_STIFFNESS,
        RATE_COEFFICIENT,
        CLEARANCE,
        TENSION,
    )

    @staticmethod
    def force(
        d: float,
        ddot: float,
        d_max: float,
        deformation: list[float],
        force: list[float],
        final_stiffness: float,
        unloading_stiffness: float,
        rate_coefficient: float,
        clearance: float,
        tension: float,
    ) -> float:
        """The force, N, compression positive."""
        turn = d_max if unloading_stiffness > 0.0 else d
        x = turn - clearance
        if deformation[0] > 0.0:
            static = force[0] * x / deformation[0]
        else:
            static = 0.0
        for i in range(len(force) - 1):
            if x >= deformation[i]:
                slope = (force[i + 1] - force[i]) / (deformation[i + 1] - deformation[i])
                static = force[i] + slope * (x - deformation[i])
        if x >= deformation[-1]:
            static = force[-1] + final_stiffness * (x - deformation[-1])
        if deformation[0] == 0.0:
            static = static + force[0] * min(0.0, x / RISE - 1.0)
        static = static - unloading_stiffness * (turn - d)
        if tension == 0.0:
            static = max(0.0, static)
        return static * max(0.0, 1.0 + rate_coefficient * ddot)
