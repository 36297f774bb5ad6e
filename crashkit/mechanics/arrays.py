"""The arrays that the compiled kernel works on: what their entries are called."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Records = NDArray[np.void]

STAGES = 5
START, END = np.int64(0), np.int64(4)
"""Rows of a step; 1 to 3 are the inner stages of the Runge-Kutta rule. (A plain 0 would be compiled as a type of its own.)"""

FORCE, D_MAX, REST = 0, 1, 2
"""Second index of the joints' derivatives `joint_tangent` (joint, 3, column)."""

BODY = np.dtype(
    [
        ("inverse_mass", np.float64),  # kg-1, 0 for a fixed body
        ("mass_column", np.int64),  # the column that is its mass, or -1
    ],
    align=True,
)
JOINT = np.dtype(
    [
        ("first", np.int64),  # its two bodies
        ("second", np.int64),
        ("direction", np.float64),  # +1 where the second body lies ahead of the first, else -1
        ("rest", np.float64),  # m, distance between the bodies' centres at which the deformation is 0
        ("start", np.int64),  # its functions: the first is its law, the others are factors
        ("stop", np.int64),
        ("force", np.float64),  # N, at the stage last evaluated
        ("d_max", np.float64),  # m, largest deformation; out of date while the joint is loaded further
        ("loading", np.int64),  # 1 while the joint is loaded beyond its largest deformation, so that d_max is d itself
    ],
    align=True,
)
FUNCTION = np.dtype(
    [
        ("number", np.int64),  # in the engine
        ("mode", np.int64),  # its branches, one bit each
        ("offset", np.int64),  # of its first parameter
        ("count", np.int64),  # of its parameters
        ("value", np.float64),  # when its derivatives were last evaluated
    ],
    align=True,
)


class Work(NamedTuple):
    """Everything that a run reads and changes, in the order in which the kernel takes it.

    Arguments:
        bodies, joints, functions: records as above.
        parameters: the numbers of all functions, one after another.
        state: (stage, 3 bodies) positions, velocities, accelerations, so that entry i + bodies is the derivative of entry i.
        columns: of each number of `parameters`, the column that it is, or -1.
        tangent: (stage, 3 bodies, column) derivatives of `state` to the columns.
        joint_tangent: derivatives of each joint's force, largest deformation and rest to the columns.
        partials: (function, 3 + parameters) derivatives of each function to d, ddot, d_max and its parameters.
    """

    bodies: Records
    joints: Records
    functions: Records
    parameters: Floats
    state: Floats
    columns: Integers
    tangent: Floats
    joint_tangent: Floats
    partials: Floats


class Record(NamedTuple):
    """What a run leaves behind, at the times asked for; no rows of derivatives where no columns are asked for.

    Arguments:
        state: (time, 3 bodies).
        force: (time, joint).
        tangent: (time, 3 bodies, column).
        force_tangent: (time, joint, column).
    """

    state: Floats
    force: Floats
    tangent: Floats
    force_tangent: Floats
