"""A body that turns acts back on its joints like a load that swings on it: that is one finding, not two."""

import math
from collections.abc import Sequence
from itertools import product

from attrs import evolve

from crashkit.diagnose.result import Finding, own_name, place_of

ROCKS, LOADED = "rotation", "carried_load"
NEAR = 0.25
"""How far the frequency of such a load may be from that of the turning, relative to it."""


def loads_that_turn(findings: Sequence[Finding]) -> list[tuple[Finding, Finding]]:
    """Bodies that turn, each with the load on it that is how it acts back on its joints.

    A force F at the distance a from the centre of mass of a body of mass m and inertia I, held by k, moves its own point by
    F / (m s^2) + a^2 F / (I s^2 + k), as if it moved a mass m / (1 + m a^2 / I) that carries the rest of m on a spring. On it
    that swings at sqrt(k / (I + m a^2)). On a line, where nothing turns, that is a load.
    """
    pairs = product(*([one for one in findings if one.physics == physics] for physics in (ROCKS, LOADED)))
    return [(rocks, load) for rocks, load in pairs if _is_same_body(rocks, load) and _swings_alike(rocks, load)]


def acting_back(rocks: Finding, load: Finding) -> Finding:
    """The turning with what it does to the joints of its body."""
    mass = load.parameters["mass"].value
    return evolve(
        rocks,
        form=f"{rocks.form}, acting back",
        sentence=f"{rocks.sentence}, and acts back on its joints as a load of {mass:.3g} kg would that swings on it",
        parameters={**rocks.parameters, **load.parameters},
        runs=tuple(dict.fromkeys((*rocks.runs, *load.runs))),
    )


def _is_same_body(rocks: Finding, load: Finding) -> bool:
    return place_of(rocks.location) == place_of(load.location)


def _swings_alike(rocks: Finding, load: Finding) -> bool:
    turning = [one.value for name, one in rocks.parameters.items() if own_name(name) == "rocking_frequency"]
    stiffness = [load.parameters[name].value for name in ("stiffness", "elastic_stiffness") if name in load.parameters]
    if not turning or not stiffness or "mass" not in load.parameters:
        return False
    swinging = math.sqrt(stiffness[0] / load.parameters["mass"].value) / (2.0 * math.pi)
    return any(abs(swinging - one) < NEAR * one for one in turning)
