"""The arrays that the compiled kernel works on, by name."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

STAGES = 5
"""Rows of a step: 0 where it starts, 1 to 3 the inner stages of the Runge-Kutta rule, 4 where it ends."""


class Structure(NamedTuple):
    """Bodies, joints and their functions; nothing in it changes during a run.

    Arguments:
        inverse_mass: (body) kg-1, 0 for a fixed body.
        first, second: (joint) index of the two bodies.
        direction: (joint) +1 where the second body lies ahead of the first, else -1.
        rest: (joint) m, the distance between the bodies' centres at which the deformation is 0.
        start: (joint + 1) a joint's functions are start[joint] to start[joint + 1]; the first is its law, the others are factors.
        function: (function) its number in the engine.
        offset: (function + 1) its parameters are offset[function] to offset[function + 1] of `parameters`.
        parameters: the numbers of all functions, one after another.
    """

    inverse_mass: Floats
    first: Integers
    second: Integers
    direction: Floats
    rest: Floats
    start: Integers
    function: Integers
    offset: Integers
    parameters: Floats


class State(NamedTuple):
    """Where the bodies are, and which branches the joints are on.

    Arguments:
        position, velocity, acceleration: (stage, body).
        force: (joint) N, at the stage last evaluated.
        d_max: (joint) m, the largest deformation reached; out of date while the joint is loaded further.
        loading: (joint) 1 while the joint is loaded beyond its largest deformation, so that d_max is d itself.
        mode: (function) its branches, one bit each.
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    force: Floats
    d_max: Floats
    loading: Integers
    mode: Integers


class Tangent(NamedTuple):
    """Derivatives of the state to the columns, the parameters asked for.

    Arguments:
        position, velocity, acceleration: (stage, body, column).
        force, deformation, d_max, rest: (joint, column).
        mass_column: (body) the column that is its mass, or -1.
        parameter_column: (parameter) the column that is this number of `Structure.parameters`, or -1.
        values: work space for the values of one joint's functions.
        partials: and for their derivatives to d, ddot, d_max and their parameters, one row each.
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    force: Floats
    deformation: Floats
    d_max: Floats
    rest: Floats
    mass_column: Integers
    parameter_column: Integers
    values: Floats
    partials: Floats


class Record(NamedTuple):
    """What a run leaves behind, at the times asked for.

    Arguments:
        position, velocity, acceleration: (time, body).
        deformation, deformation_rate, force: (time, joint).
        position_sensitivity, velocity_sensitivity, acceleration_sensitivity: (time, body, column).
        deformation_sensitivity, force_sensitivity: (time, joint, column).
    """

    position: Floats
    velocity: Floats
    acceleration: Floats
    deformation: Floats
    deformation_rate: Floats
    force: Floats
    position_sensitivity: Floats
    velocity_sensitivity: Floats
    acceleration_sensitivity: Floats
    deformation_sensitivity: Floats
    force_sensitivity: Floats
