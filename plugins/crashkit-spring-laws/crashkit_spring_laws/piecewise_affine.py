"""A force curve given by its corners."""

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, RATE_COEFFICIENT, TENSION, TENSION_FORCE, TOE, UNLOADING_STIFFNESS

RISE = 1e-4
"""m, over which a force given at deformation 0 is reached."""


class PiecewiseAffine(SpringLaw):
    """A succession of affine segments (Mizzi & Jezequel 1992, Fig 2).

    With x = d - clearance, F_load is the broken line from (0, 0) through (deformation[i], force[i]), then `final_stiffness`.
    F_s = F_load(d_max) - k (d_max - d); without unloading stiffness k, F_s = F_load(d).
    F = F_s max(0, 1 + a ddot) where F_s pushes, and F = tension F_s max(0, 1 - a ddot) where it pulls,
    at most `tension_force`.

    A toe t makes x = (d - clearance)^2 / (2 t) up to d - clearance = t, and d - clearance - t / 2 from there on.
    Where the first corner is at deformation 0, its force is reached within 0.1 mm, because a force must be continuous.
    A plain 0 stays 0, be it a deformation or a force; what is to be sought from 0 is written `{value = 0.0}`.
    With `tension` the first line goes on below x = 0, the unloading line goes on below F_s = 0, and so both pull.
    """

    name = "piecewise_affine"
    parameters = (
        ParameterSpec(
            "deformation", "m", "deformation at the corners, increasing", lower=0.0, vector=True, increasing=True, null=0.0
        ),
        ParameterSpec("force", "N", "force at the corners", vector=True, null=0.0),
        ParameterSpec("final_stiffness", "N m-1", "slope after the last corner", default=0.0),
        UNLOADING_STIFFNESS,
        RATE_COEFFICIENT,
        CLEARANCE,
        TENSION,
        TENSION_FORCE,
        TOE,
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
        tension_force: float,
        toe: float,
    ) -> float:
        """The force, N, compression positive."""
        turn = d_max if unloading_stiffness > 0.0 else d
        added = 0.0
        x = turn - clearance
        if toe > 0.0:
            if x >= toe:
                x = x - 0.5 * toe
            elif x > 0.0:
                x = 0.5 * x * x / toe
        if deformation[0] > 0.0:
            start, end, low, high = 0.0, deformation[0], 0.0, force[0]
        elif len(force) > 1:
            start, end, low, high = 0.0, deformation[1], force[0], force[1]
        else:
            start, end, low, high = 0.0, 1.0, force[0], force[0] + final_stiffness
        for i in range(len(force) - 1):
            if x >= deformation[i]:
                start, end, low, high = deformation[i], deformation[i + 1], force[i], force[i + 1]
        if x >= deformation[-1]:
            start, end, low, high = deformation[-1], deformation[-1] + 1.0, force[-1], force[-1] + final_stiffness
        static = low + (high - low) * (x - start) / (end - start)
        if deformation[0] == 0.0:
            static = static + force[0] * min(0.0, x / RISE - 1.0)
        static = static + added - unloading_stiffness * (turn - d)
        if static >= 0.0:
            return static * max(0.0, 1.0 + rate_coefficient * ddot)
        return max(-tension_force, tension * static * max(0.0, 1.0 - rate_coefficient * ddot))
