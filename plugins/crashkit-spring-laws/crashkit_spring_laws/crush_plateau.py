"""A member that buckles: elastic, plateau, densification."""

from crashkit.protocols import ParameterSpec, SpringLaw
from crashkit_spring_laws.shared import CLEARANCE, RATE_COEFFICIENT, TENSION, TENSION_FORCE, TOE, UNLOADING_STIFFNESS


class CrushPlateau(SpringLaw):
    """Elastic slope, buckling plateau, densification slope (Mizzi & Jezequel 1992, Fig 2, eq 1 and 40).

    With x = d - clearance, F_load = alpha x up to delta; delta up to x = max(gamma, delta / alpha); then + beta (x - that).
    F_s = F_load(d_max) - k (d_max - d); without unloading stiffness k, F_s = F_load(d).
    F = F_s max(0, 1 + a ddot) where F_s pushes, and F = tension F_s max(0, 1 - a ddot) where it pulls,
    at most `tension_force`.

    A toe t makes x = (d - clearance)^2 / (2 t) up to d - clearance = t, and d - clearance - t / 2 from there on.

    With `tension` the elastic line goes on below x = 0 and the unloading line below F_s = 0, and so both pull: a member that
    was never crushed beyond its clearance pulls along the unloading line from its elastic force at d_max. The rate raises what
    resists, and lowers what is given back. An unloading stiffness below a loading slope would give back more than it took.
    """

    name = "crush_plateau"
    parameters = (
        ParameterSpec("elastic_stiffness", "N m-1", "slope before buckling (alpha)", lower=1.0),
        ParameterSpec("crush_force", "N", "force of the buckling plateau (delta)", lower=1.0),
        ParameterSpec("densification_deformation", "m", "where the plateau ends (gamma)", lower=1e-4),
        ParameterSpec("densification_stiffness", "N m-1", "slope after the plateau (beta)", lower=1.0),
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
        elastic_stiffness: float,
        crush_force: float,
        densification_deformation: float,
        densification_stiffness: float,
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
        densification = max(densification_deformation, crush_force / elastic_stiffness)
        if x >= densification:
            static = crush_force + densification_stiffness * (x - densification)
        elif elastic_stiffness * x >= crush_force:
            static = crush_force
        else:
            static = elastic_stiffness * x
        static = static + added - unloading_stiffness * (turn - d)
        if static >= 0.0:
            return static * max(0.0, 1.0 + rate_coefficient * ddot)
        return max(-tension_force, tension * static * max(0.0, 1.0 - rate_coefficient * ddot))
