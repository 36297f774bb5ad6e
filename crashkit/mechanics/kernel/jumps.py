# mypy: disable-error-code="no-untyped-def, no-untyped-call, assignment"
"""Crossings: branches change, and where a force jumps, so do the derivatives (saltation).

With f- and f+ the state's derivative on the two sides of a jump, and g the guard whose zero it is, the derivatives to a column
c jump by (f- - f+) tau_c, where tau_c = -g_c / g' is the derivative of the time of the crossing. The adjoint lam receives the
transpose: what stands before tau_c, (f- - f+)' lam, is carried back through tau_c.
"""

import math

from crashkit.mechanics.kernel.arrays import (
    D_MAX,
    DEFORMATION,
    FORCES,
    NONE,
    RATE,
    START,
    TO_D,
    TO_D_MAX,
    TO_MEMORY,
    TO_PARAMETERS,
    TO_RATE,
)
from crashkit.mechanics.kernel.forces import accelerate, kinematics
from crashkit.mechanics.kernel.line import CURVED, DOF, bend, locate
from crashkit.mechanics.kernel.stand_ins import compiled, law_guard
from crashkit.mechanics.kernel.steps import choose_branches_of
from crashkit.mechanics.kernel.tangents import deformation_tangent, freeze_tangent

# ---- compiled from here ----


@compiled
def jumping_function(bodies, joint, functions, parameters, state, partials):
    """The function of a joint whose guard, crossed at START, may be that of a jump, or NONE; its slopes are in `partials`.

    A force may also jump where the joint turns round at its largest deformation: the guard is then the rate.
    """
    d, ddot = kinematics(bodies, joint, state, START)
    d_max, turns = joint.d_max, False
    if joint.loading:
        d_max, turns = d, ddot < 0.0
    for f in range(joint.start, joint.stop):
        function, slopes = functions[f], partials[f]
        o, z = function.offset, 0.0
        guard = math.inf
        if function.memory >= 0:
            z = state[START, function.memory]
            guard = law_guard(function.memory_code, function.memory_mode, d, ddot, d_max, z, parameters, o, slopes)
        if guard >= 0.0:
            guard = min(guard, law_guard(function.code, function.mode, d, ddot, d_max, z, parameters, o, slopes))
        if guard < 0.0:
            return f
        if turns and guard < math.inf:
            for i in range(TO_PARAMETERS + function.count):
                slopes[i] = 1.0 if i == TO_RATE else 0.0
            return f
    return NONE


@compiled
def acceleration_of(bodies, joint, state):
    """The second derivative of a joint's deformation in time, at START."""
    n, second = DOF * bodies.size, 0.0
    a, b = n + DOF * joint.first, n + DOF * joint.second
    first = state.shape[1] // 2
    for i in range(DOF):
        joint.along[i] = state[START, a + i]
        joint.along[DOF + i] = state[START, b + i]
        second += joint.gradient[i] * state[START, first + a + i] + joint.gradient[DOF + i] * state[START, first + b + i]
    if CURVED:
        bend(bodies, joint)
        for i in range(2 * DOF):
            second += joint.bend[i] * joint.along[i]
    return second


@compiled
def lateness(bodies, joint, function, state, slopes):
    """How the time of a crossing changes with its guard, -1 / g', at START.

    A guard that stands still, as between bodies that begin at rest to one another, is not crossed at any time: 0.
    """
    speed = slopes[TO_D] * joint.ddot + slopes[TO_RATE] * acceleration_of(bodies, joint, state)
    if joint.loading:
        speed += slopes[TO_D_MAX] * joint.ddot
    if function.memory >= 0:
        speed += slopes[TO_MEMORY] * state[START, state.shape[1] // 2 + function.memory]
    return -1.0 / speed if speed != 0.0 else 0.0


@compiled
def moment_tangent(function, columns, tangent, own, slopes, late):
    """Derivatives of the time of a crossing whose guard has these slopes, into `own[FORCES]`."""
    z = function.memory
    for c in range(tangent.shape[2]):
        change = slopes[TO_D] * own[DEFORMATION, c] + slopes[TO_RATE] * own[RATE, c] + slopes[TO_D_MAX] * own[D_MAX, c]
        own[FORCES, c] = late * (change + slopes[TO_MEMORY] * tangent[START, z, c]) if z >= 0 else late * change
    for i in range(function.count):
        if columns[function.offset + i] >= 0:
            own[FORCES, columns[function.offset + i]] += late * slopes[TO_PARAMETERS + i]


@compiled
def change_branches(
    bodies,
    joints,
    functions,
    parameters,
    given,
    state,
    columns,
    partials,
    tangent,
    joint_tangent,
    net_tangent,
    t,
    piece,
    ahead,
):
    """Change to the branches beyond a crossing, one joint after another; returns the smallest guard there and its joint.

    Where the force of a joint jumps, the derivatives are given their jump.
    """
    size, f = state.shape[1] // 2, NONE
    locate(bodies, state, START)
    if tangent.shape[2] > 0:
        freeze_tangent(bodies, joints, state, tangent, joint_tangent, net_tangent)
    for j in range(joints.size):
        joint, own = joints[j], joint_tangent[j]
        if tangent.shape[2] > 0:
            f = jumping_function(bodies, joint, functions, parameters, state, partials)
        if f != NONE:
            accelerate(bodies, joints, functions, parameters, given, state, START, t, piece)  # with the joints changed before
            deformation_tangent(bodies, joint, state, tangent, own, net_tangent, START)
            late = lateness(bodies, joint, functions[f], state, partials[f])
            moment_tangent(functions[f], columns, tangent, own, partials[f], late)
        choose_branches_of(bodies, joint, functions, parameters, state, ahead)
        if f != NONE:
            for i in range(size):
                state[1, size + i] = state[START, size + i]
            accelerate(bodies, joints, functions, parameters, given, state, START, t, piece)
            for i in range(size):
                jump = state[1, size + i] - state[START, size + i]
                for c in range(tangent.shape[2]):
                    tangent[START, i, c] += jump * own[FORCES, c]
    return accelerate(bodies, joints, functions, parameters, given, state, START, t, piece)
