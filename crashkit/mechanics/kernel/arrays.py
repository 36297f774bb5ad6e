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
NONE = np.int64(-1)
"""No joint, no entry."""

D_MAX, REST, DEFORMATION, RATE, DEFORMATION_BEFORE, RATE_BEFORE, FORCES = 0, 1, 2, 3, 4, 5, 6
"""Second index of the joints' derivatives `joint_tangent` (joint, 11, column); those of the force take one for each stage."""

TO_D, TO_RATE, TO_D_MAX, TO_MEMORY, TO_PARAMETERS = 0, 1, 2, 3, 4
"""Entries of a function's derivatives `partials` (function, 4 + parameters)."""

TOTAL = 5
"""First index of `net`, after the forces of the joints at each stage: with what is given."""

BODY = np.dtype(
    [
        ("inverse_mass", np.float64),  # kg-1, 0 for a body that no force moves
        ("mass_column", np.int64),  # the column that is its mass, or -1
        ("inertia", np.float64, (2, 3, 3)),  # kg m2 about its own axes, and the inverse; 0 for a body that no moment turns
        ("inertia_columns", np.int64, (6,)),  # the columns that are xx, yy, zz, xy, xz, yz, or -1
        (
            "frame",
            np.float64,
            (13,),
        ),  # rotation matrix of the stage by rows, unit quaternion at the last step; plane: cos, sin
        (
            "net",
            np.float64,
            (6, 6),
        ),  # force and moment: of its joints at each stage; at the last that was evaluated, with what is given
    ],
    align=True,
)
JOINT = np.dtype(
    [
        ("first", np.int64),  # its two bodies
        ("second", np.int64),
        ("pushed_first", np.int64),  # the bodies on which its force acts: the same two but for a linkage
        ("pushed_second", np.int64),
        ("face", np.int64),  # 1 where it pushes along the normal of a face of its first body, not along its own line
        (
            "places",
            np.float64,
            (9,),
        ),  # m, the attachments in their bodies' frames and the normal of the face, three numbers each
        ("point_columns", np.int64, (6,)),  # the columns that are coordinates of the attachments, the axes of the model, or -1
        ("moves_points", np.int64),  # 1 where one of them is a column
        ("aim", np.float64, (3,)),  # direction at the end of the last step; 0 before the first
        ("rest", np.float64),  # m, distance at which the deformation is 0
        ("start", np.int64),  # its functions: the first is its law, the others are factors
        ("stop", np.int64),
        ("d", np.float64),  # m and m s-1, at the stage last evaluated
        ("ddot", np.float64),
        ("forces", np.float64, (5,)),  # N, at each stage
        ("d_max", np.float64),  # m, largest deformation; out of date while the joint is loaded further
        ("loading", np.int64),  # 1 while the joint is loaded beyond its largest deformation, so that d_max is d itself
        ("gradient", np.float64, (18,)),  # of the deformation to the positions of its bodies, then to its attachments
        ("shape", np.float64, (8,)),  # what the geometry keeps of its position for derivatives
        ("along", np.float64, (12,)),  # a motion of its two bodies, and
        ("bend", np.float64, (18,)),  # how the gradient changes along it
        ("guard", np.float64),  # smallest of its branches, at the stage last evaluated
        ("d_before", np.float64),  # m and m s-1, where the step begins
        ("ddot_before", np.float64),
    ],
    align=True,
)
FUNCTION = np.dtype(
    [
        ("code", np.int64),  # address of the table of its functions
        ("mode", np.int64),  # its branches, one bit each
        ("driver", np.int64),  # the joint whose deformation it takes, or -1: its own
        ("offset", np.int64),  # of its first parameter
        ("count", np.int64),  # of its parameters
        ("value", np.float64),  # when its derivatives were last evaluated
        ("memory", np.int64),  # the entry of the state that is its memory, or -1
        ("memory_code", np.int64),  # the same of the function that is the rate of its memory
        ("memory_mode", np.int64),
    ],
    align=True,
)


class Work(NamedTuple):
    """Everything that a run reads and changes, in the order in which the kernel takes it.

    With n = DOF x bodies velocities (DOF = 1, 3 or 6 by the number of axes: along the axes, then about them) and m memories,
    the state is y = (n positions, n velocities, m memories). In space the rotational positions are a rotation vector from the
    orientation at the last step, so that they are 0 there.

    Arguments:
        bodies, joints, functions: records as above.
        parameters: the numbers of all functions, one after another.
        given: (knot, 1 + 4 n) force and acceleration that are given, affine between knots: time of the knot, s, value and
            slope of the force, value and slope of the acceleration.
        state: (stage, 2 (2 n + m)) y and its derivative.
        columns: of each number of `parameters`, the column that it is, or -1.
        partials: (function, 4 + parameters) derivatives of each function to d, ddot, d_max, its memory and its parameters.
        tangent: (stage, 2 (2 n + m), column) derivatives of `state` to the columns.
        joint_tangent: (joint, 11, column) of each joint's largest deformation, rest, deformation and rate, those where the
            step begins, and its force at each stage.
        net_tangent: (stage, n, column) of the forces and moments on the bodies.
    """

    bodies: Records
    joints: Records
    functions: Records
    parameters: Floats
    given: Floats
    state: Floats
    columns: Integers
    partials: Floats
    tangent: Floats
    joint_tangent: Floats
    net_tangent: Floats


class Record(NamedTuple):
    """What a run leaves behind, at the times asked for.

    Arguments:
        values: (time, slot), the entries that are asked for.
        tangents: (time, slot, column) derivatives of all but the quaternions; no times where no columns are asked for.
        slots: where each entry stands, or -1. The entries are y and its derivative; force, deformation and rate of each
            joint; force and moment of the joints on each body; in space the unit quaternion of each body.
    """

    values: Floats
    tangents: Floats
    slots: Integers
