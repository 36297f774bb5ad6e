# mypy: disable-error-code="no-untyped-def, no-untyped-call, assignment"
"""Forces and accelerations at a stage of a step."""

import math

from crashkit.mechanics.kernel.arrays import NONE, TOTAL
from crashkit.mechanics.kernel.line import DOF, locate, measure, rates, respond
from crashkit.mechanics.kernel.stand_ins import compiled, inlined, law_frozen

# ---- compiled from here ----

ROUNDING = 1e-13
"""m and m s-1, by which a joint may seem to turn round only because of rounding: bodies that move alike, for example."""


@inlined
def kinematics(bodies, joint, state, row):
    """Deformation and rate of a joint, whose gradient is taken anew."""
    n = DOF * bodies.size
    a, b = n + DOF * joint.first, n + DOF * joint.second
    d = joint.rest - measure(bodies, joint, state, row)
    ddot = 0.0
    for i in range(DOF):
        ddot += joint.gradient[i] * state[row, a + i] + joint.gradient[DOF + i] * state[row, b + i]
    joint.d = d
    joint.ddot = ddot
    return d, ddot


@inlined
def joint_force(joints, joint, functions, parameters, state, row, d, ddot):
    """Force of a joint on its frozen branches, and its smallest guard; the rates of its memories go to the state."""
    size = state.shape[1] // 2
    d_max, guard = joint.d_max, joint.d_max - d + ROUNDING
    if joint.loading:
        d_max, guard = d, ddot + ROUNDING
    force = 1.0
    for f in range(joint.start, joint.stop):
        function = functions[f]
        memory, z = function.memory, 0.0
        if function.driver >= 0:
            driver = joints[function.driver]
            force *= law_frozen(function.code, 0, driver.d, driver.ddot, driver.d, z, parameters, function.offset)[0]
            continue
        if memory >= 0:
            z = state[row, memory]
            code, mode = function.memory_code, function.memory_mode
            rate, distance = law_frozen(code, mode, d, ddot, d_max, z, parameters, function.offset)
            state[row, size + memory] = rate
            guard = min(guard, distance)
        value, distance = law_frozen(function.code, function.mode, d, ddot, d_max, z, parameters, function.offset)
        force *= value
        guard = min(guard, distance)
    return force, guard


@inlined
def begin_forces(bodies, state, row):
    """Turn the frames to a stage and take all forces away."""
    locate(bodies, state, row)
    for body in bodies:
        for i in range(DOF):
            body.net[row, i] = 0.0


@inlined
def push(bodies, joint, row, force):
    """Put the force of a joint at a stage on its bodies."""
    joint.forces[row] = force
    for i in range(DOF):
        bodies[joint.pushed_first].net[row, i] -= force * joint.gradient[i]
        bodies[joint.pushed_second].net[row, i] -= force * joint.gradient[DOF + i]


@inlined
def add_given(bodies, given, row, t, piece):
    """Add the forces that are given to those of the joints at a stage."""
    n, since = DOF * bodies.size, t - given[piece, 0]
    for i in range(n):
        body, k = bodies[i // DOF], i % DOF
        body.net[TOTAL, k] = body.net[row, k] + given[piece, 1 + i] + since * given[piece, 1 + n + i]


@inlined
def accelerate_stage(bodies, joints, functions, parameters, given, state, row, t, piece):
    """Forces, and the derivative of the state, at a stage.

    Returns:
        the smallest guard (minus infinity: a force that is not finite) and its joint.
    """
    n = DOF * bodies.size
    first, since = state.shape[1] // 2 + n, t - given[piece, 0]
    begin_forces(bodies, state, row)
    smallest, culprit = math.inf, NONE
    for joint in joints:
        kinematics(bodies, joint, state, row)
    for j in range(joints.size):
        joint = joints[j]
        d = joint.d
        force, guard = joint_force(joints, joint, functions, parameters, state, row, d, joint.ddot)
        if not (math.isfinite(force) and math.isfinite(d)):
            guard = -math.inf
        joint.guard = guard
        if guard < smallest:
            smallest, culprit = guard, j
        push(bodies, joint, row, force)
    add_given(bodies, given, row, t, piece)
    respond(bodies, state, row)
    for i in range(n):
        state[row, first + i] += given[piece, 1 + 2 * n + i] + since * given[piece, 1 + 3 * n + i]
    rates(bodies, state, row)
    return smallest, culprit


@compiled
def accelerate(bodies, joints, functions, parameters, given, state, row, t, piece):
    """The same, for who does it seldom."""
    return accelerate_stage(bodies, joints, functions, parameters, given, state, row, t, piece)
